#include "support/machine.hpp"

#include "io/read_scene.hpp"
#include "system/measure.hpp"

namespace bramah::testing {

std::shared_ptr<Registry> registry() {
  const std::string build = BRAMAH_BINARY_DIR;
  return std::make_shared<Registry>(
      std::vector<std::filesystem::path>{build + "/lib/bramah/plugins", build + "/tests/plugins"});
}

double Machine::value(const State& state, const std::string& name) const {
  Measured found;
  if (!find_measured(system(), name, found)) throw std::runtime_error("no variable " + name);
  return Meter(system(), {found}).read(state)[0];
}

Machine load(const std::string& file, const std::vector<std::string>& settings) {
  Machine machine;
  machine.scene = read_scene(std::string(BRAMAH_SOURCE_DIR) + "/" + file);
  for (const std::string& setting : settings) apply_setting(machine.scene, setting);
  machine.compiled = compile(machine.scene, registry());
  return machine;
}

LinearModel linear_model(const Machine& machine, const State& state) {
  Linearizer linearizer(machine.system(),
                        choose_partition(machine.system(), state, machine.options().linearize.prescribed));
  LinearModel model;
  linearizer.linearize(state, model);
  linearizer.estimate_rounding(model);
  return model;
}

std::vector<std::complex<double>> eigenvalues(const LinearModel& model) {
  std::vector<std::complex<double>> list;
  for (const Mode& mode : find_spectrum(model).modes) list.push_back(mode.eigenvalue);
  return list;
}

}  // namespace bramah::testing
