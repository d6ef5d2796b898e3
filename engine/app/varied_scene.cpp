#include "app/varied_scene.hpp"

#include "io/json_writer.hpp"

namespace bramah {

VariedScene::Compilation::Compilation(VariedScene& owner, const std::vector<double>& values) : owner_(owner) {
  Scene scene = owner.scene_;
  for (std::size_t k = 0; k < values.size(); ++k) apply_setting(scene, owner.names_[k] + "=" + exact_number(values[k]));
  const std::scoped_lock lock(owner.mutex_);
  compiled_.emplace(compile(scene, owner.registry_));
}

VariedScene::Compilation::~Compilation() {
  const std::scoped_lock lock(owner_.mutex_);
  compiled_.reset();
}

}  // namespace bramah
