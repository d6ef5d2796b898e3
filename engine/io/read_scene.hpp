// JSON to Scene: syntax, duplicate keys, depth and the shape of the document. Meaning is `compile`'s.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "system/analysis_error.hpp"
#include "system/diagnostic.hpp"
#include "system/scene.hpp"

namespace bramah {

/// Reads a scene file (UTF-8 JSON, a byte order mark is allowed; // and /* */ are comments). Throws SceneError with
/// every fault found; after a syntax error only what stands before it has been read.
Scene read_scene(const std::filesystem::path& file);

/// The file's text alone, so that faults thrown by `read_scene_text` can be rendered with their places. Throws
/// SceneError where there is no readable file of at most 1 GiB.
Source read_source(const std::filesystem::path& file);

/// The same from text; `name` stands for the file in messages. With `of_shape`, faults that leave the scene readable (an
/// unknown key, a missing version) go there, so that `compile` can report them with its own: all in one go.
Scene read_scene_text(std::string_view text, std::string_view name, std::vector<Diagnostic>* of_shape = nullptr);

/// 1-based line and column (in characters, not bytes).
struct Place {
  std::size_t line = 1;
  std::size_t column = 1;
};
/// Where a diagnostic points to in the text; the closest existing parent where the pointer itself does not exist.
Place locate(const Source& source, const Diagnostic& diagnostic);

/// The same for all of them, in one walk through the text.
std::vector<Place> locate_all(const Source& source, const std::vector<Diagnostic>& diagnostics);

/// The message that users read, one block per fault:
///   scenes/bad.json:12:15: error: unknown key "volum" of hydraulics/hose   [unknown-key]
///     at        /components/hose2/volum
///     expected  one of: volume, V_h, B_h, B_oil
///     to do     did you mean "volume"?
/// In the order of their places; of more than a hundred the first hundred, and how many more there are. The place is left out for faults of the document as a whole and for scenes without text;
/// empty lines are left out.
std::string render(const Source& source, const SceneError& error);
/// The same for an analysis without an answer; the place is that of the component or key to look at.
std::string render(const Source& source, const AnalysisError& error);

}  // namespace bramah
