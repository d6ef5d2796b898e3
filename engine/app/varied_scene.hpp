// The scene at other values of some of its numbers: what `sweep` and `vary` share.
#pragma once

#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/context.hpp"

namespace bramah {

/// Compiles the scene with numbers set as `--set` would set them, from any thread.
class VariedScene {
 public:
  VariedScene(const Context& context, std::vector<std::string> names)
      : scene_{context.scene.root, {context.scene.source.name, ""}}, names_(std::move(names)) {}

  /// Libraries may be asked from any thread to evaluate only: making and unmaking instances takes turns.
  class Compilation {
   public:
    /// At `values` of the names, SI. Throws SceneError.
    Compilation(VariedScene& owner, const std::vector<double>& values);
    Compilation(const Compilation&) = delete;
    Compilation& operator=(const Compilation&) = delete;
    ~Compilation();
    [[nodiscard]] const Compiled& get() const { return *compiled_; }

   private:
    VariedScene& owner_;
    std::optional<Compiled> compiled_;
  };

 private:
  Scene scene_;
  std::vector<std::string> names_;
  std::shared_ptr<Registry> registry_ = std::make_shared<Registry>();
  std::mutex mutex_;
};

/// One line on why `work` has no answer; "" where it has one.
template <class Work>
std::string reason_against(Work&& work) {
  try {
    work();
    return "";
  } catch (const SceneError& error) {
    const Diagnostic& d = error.diagnostics().front();
    return d.pointer + ": " + d.found + "; expected " + d.expected + "; " + d.remedy;
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace bramah
