// Machines at the edges: each folder beside this file has a scene.json and a case.json that says what is right and why.
//
//   command      arguments of bramah; simulations run with every integrator, or those of "integrators"
//   fixed_step   of the generalized-alpha method, where it can meet the tolerances
//   right, or    a list of what must hold; "or" is another right answer
//     name, value, tol, why   a number of the JSON document or of the time series: NAME of the last row, NAME@T, min NAME,
//                             max NAME, "events NAME", "eigenvalue" and "critical" (the nearest), exit, zeros, ...
//     says, silent            regular expressions over all that was printed
//     refuse                  exit code 1 or 2 and a message that names these
#include <cmath>
#include <complex>
#include <regex>

#include "app/cli.hpp"
#include "support/numbers.hpp"

namespace bramah {
namespace {

const fs::path here = BRAMAH_SOURCE_DIR "/tests/cases";

/// One line of a CSV file; names with commas or quotes are quoted.
std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> result(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      result.emplace_back();
    } else if (c != '\r') {
      result.back() += c;
    }
  }
  return result;
}

bool contains(const std::string& text, const std::string& pattern) {
  return std::regex_search(text, std::regex(pattern, std::regex::ECMAScript | std::regex::icase));
}

/// What one call answered.
class Answer {
 public:
  Answer(const Ended& run, const fs::path& series) : code_(run.code), text_(run.out + "\n" + run.err) {
    document_ = json::parse(run.out, nullptr, false);
    std::istringstream lines(contents(series));
    for (std::string line; std::getline(lines, line);) (names_.empty() ? names_ : rows_.emplace_back()) = fields(line);
  }

  /// Why `item` does not hold, or "".
  [[nodiscard]] std::string wrong(const json& item) const {
    if (item.contains("refuse")) {
      if (code_ != 1 && code_ != 2) return "exit code " + std::to_string(code_) + ", not refused";
      for (const std::string& word : list(item["refuse"]))
        if (!contains(text_, word)) return "the message does not name " + word + ":\n" + text_;
      return "";
    }
    if (item.contains("says") || item.contains("silent")) {
      const bool says = item.contains("says");
      for (const std::string& word : list(item[says ? "says" : "silent"]))
        if (contains(text_, word) != says) return (says ? "does not say " : "says ") + word + ":\n" + text_;
      return "";
    }
    const json& value = item["value"];
    const std::complex<double> expected =
        value.is_array() ? std::complex<double>(value[0], value[1]) : std::complex<double>(value.get<double>());
    const std::string name = item["name"];
    const std::vector<std::complex<double>> found = numbers(name);
    double error = HUGE_VAL;
    std::complex<double> nearest = NAN;
    for (const auto number : found) {
      if (std::abs(number - expected) >= error) continue;
      error = std::abs(number - expected);
      nearest = number;
    }
    const double tolerance = item.value("tol", 0.0);
    if (error <= tolerance) return "";
    std::ostringstream text;
    text.precision(17);
    text << name << ": found " << nearest << ", expected " << expected << ", error " << error << ", tolerance "
         << tolerance << ", exit code " << code_;
    return text.str();
  }

 private:
  static std::vector<std::string> list(const json& words) {
    return words.is_array() ? words.get<std::vector<std::string>>() : std::vector<std::string>{words};
  }
  [[nodiscard]] std::vector<double> column(const std::string& name) const {
    const auto at = std::find(names_.begin(), names_.end(), name);
    std::vector<double> result;
    if (at == names_.end()) return result;
    for (const auto& row : rows_) result.push_back(std::stod(row.at(static_cast<std::size_t>(at - names_.begin()))));
    return result;
  }
  [[nodiscard]] double element(const std::smatch& match) const {
    const json& model = match[2].matched ? at_time(document_["models"], std::stod(match[2])) : document_;
    const std::string matrix = match[3];
    const json& states = model.contains("states") ? model["states"] : document_.at("states");
    const auto index = [](const json& names, const std::string& name) {
      return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    };
    const json& rows = matrix == "A" || matrix == "B" ? states : document_["outputs"];
    const json& columns = matrix == "A" || matrix == "C" ? states : document_["inputs"];
    return model[matrix].at(index(rows, match[4])).at(index(columns, match[5]));
  }
  static const json& at_time(const json& models, double time) {
    return *std::find_if(models.begin(), models.end(),
                         [&](const json& model) { return std::abs(model["time"].get<double>() - time) < 1e-9; });
  }
  /// All numbers that `name` may mean.
  [[nodiscard]] std::vector<std::complex<double>> numbers(const std::string& name) const {
    std::smatch match;
    if (name == "exit") return {static_cast<double>(code_)};
    if (name == "eigenvalue") {
      std::vector<std::complex<double>> result;
      for (const json& e : document_.value("eigenvalues", json::array())) result.emplace_back(e["re"], e["im"]);
      return result;
    }
    if (name == "critical") {
      std::vector<std::complex<double>> result;
      for (const json& c : document_.value("critical", json::array())) result.emplace_back(c["at"][0].get<double>());
      return result;
    }
    if (name == "states") return {static_cast<double>(document_.value("states", json::array()).size())};
    if (name == "zeros" || name == "unstable" || name == "failed") return {document_.at(name).get<double>()};
    if (name.rfind("events ", 0) == 0) {
      double count = 0.0;
      for (const json& event : document_["summary"].value("events", json::array()))
        count += event.value("name", event.value("event", "")) == name.substr(7) ? 1.0 : 0.0;
      return {count};
    }
    if (std::regex_match(name, match, std::regex(R"((t=(\S+) )?([ABCD])\[(.+), (.+)\])"))) return {element(match)};
    for (const bool largest : {true, false}) {
      if (name.rfind(largest ? "max " : "min ", 0) != 0) continue;
      const std::vector<double> values = column(name.substr(4));
      if (values.empty()) return {};
      return {largest ? *std::max_element(values.begin(), values.end())
                      : *std::min_element(values.begin(), values.end())};
    }
    if (const std::size_t at = name.find('@'); at != std::string::npos) {
      const std::vector<double> times = column("time"), values = column(name.substr(0, at));
      std::vector<std::complex<double>> last;
      for (std::size_t k = 0; k < values.size(); ++k)
        if (std::abs(times[k] - std::stod(name.substr(at + 1))) < 1e-9) last = {values[k]};
      return last;
    }
    if (const std::vector<double> values = column(name); !values.empty()) return {values.back()};
    for (const char* part : {"variables", "multipliers", "inputs"}) {
      if (!document_.contains(part) || !document_[part].contains(name)) continue;
      const json& found = document_[part][name];
      return {found.is_object() ? found["value"].get<double>() : found.get<double>()};
    }
    return {};
  }

  int code_;
  std::string text_;
  json document_;
  std::vector<std::string> names_;
  std::vector<std::vector<std::string>> rows_;
};

class Case : public Cli, public ::testing::WithParamInterface<std::string> {
 protected:
  /// Runs the command with `more` arguments; why the answer is not right, or "".
  [[nodiscard]] std::string run(const json& test, const std::string& more) const {
    fs::remove_all(folder_ / "out");
    const std::string command = test["command"];
    const bool simulates = command.rfind("simulate", 0) == 0;
    const Ended ended = bramah(command + more + " --json" + (simulates ? " --out out" : ""));
    Ended all = ended;
    if (!simulates) all.err += bramah(command + more).out;  // what a person sees
    const Answer answer(all, folder_ / "out" / "time_series.csv");
    std::string text;
    for (const char* way : {"right", "or"}) {
      if (!test.contains(way)) continue;
      std::string fault;
      for (const json& item : test[way].is_array() ? test[way] : json::array({test[way]})) {
        fault = answer.wrong(item);
        if (!fault.empty()) break;
      }
      if (fault.empty()) return "";
      text += fault + "\n";
    }
    return text;
  }
};

TEST_P(Case, IsRight) {
  fs::copy(here / GetParam(), folder_, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  const json test = json::parse(contents(folder_ / "case.json"));
  SCOPED_TRACE(test["title"].get<std::string>());
  std::vector<std::string> ways = {""};
  const json scene = json::parse(contents(folder_ / "scene.json"));
  if (test["command"].get<std::string>().rfind("simulate", 0) == 0) {
    for (const std::string& name : test.value("integrators", std::vector<std::string>{"ida", "explicit", "implicit"}))
      ways.push_back(" --set simulate.integrator=" + name);
    if (test.contains("fixed_step"))
      ways.push_back(" --set simulate.integrator=generalized_alpha --set \"simulate.step=" +
                     test["fixed_step"].get<std::string>() + "\"");
  }
  for (const std::string& way : ways) EXPECT_EQ(run(test, way), "") << "with" << way;
}

std::vector<std::string> folders() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(here))
    if (fs::exists(entry.path() / "case.json")) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(Edges, Case, ::testing::ValuesIn(folders()), [](const auto& of) {
  std::string name = of.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace bramah
