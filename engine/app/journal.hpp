// What a study of many points has found so far, in a file of its own: a run that is interrupted, killed or out of room goes
// on from it.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/context.hpp"
#include "io/json_writer.hpp"
#include "io/output_file.hpp"
#include "system/scene.hpp"

namespace bramah {

/// A line of JSON for each point, written as soon as it is known. Points are found by the numbers that they were computed
/// at, bit for bit. The first line says which study of which scene it is.
class Journal {
 public:
  /// `study`: "vary" or "sweep". Claims the folder of --out and writes NAME there; without --out nothing is written. Reads
  /// the journal of --resume. Throws WriteError, and Failure where that journal belongs to another study, scene or version.
  Journal(const Context& context, const std::string& study, const std::string& name);

  /// What an earlier run has found at a point: the object that `add` wrote; null where nothing.
  [[nodiscard]] const Value* find(const std::vector<double>& at) const;
  /// Writes a point, from any thread. `write` adds members to the point's object.
  void add(const std::vector<double>& at, const std::function<void(JsonWriter&)>& write);
  /// No more can be written: further work would be lost.
  [[nodiscard]] bool is_broken() const { return broken_; }
  /// Throws the WriteError that broke it, with what to do.
  void check() const;
  /// Once the results are written: the journal of a complete study is removed, that of an interrupted one is kept and named.
  void finish(bool interrupted);
  /// What an interrupted run says at its end; empty without --out.
  [[nodiscard]] std::string last_words() const;

 private:
  /// The lines of its points. Failure where it does not begin with `header`.
  std::string read(const std::filesystem::path& file, const std::string& header);
  std::filesystem::path file_;
  std::map<std::vector<double>, Value> points_;
  std::optional<OutputFile> out_;
  std::mutex mutex_;
  std::atomic<bool> broken_ = false;
  std::optional<WriteError> error_;
};

}  // namespace bramah
