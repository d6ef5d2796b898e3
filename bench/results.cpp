#include "results.hpp"

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "io/parse_json.hpp"
#include "io/read_scene.hpp"

namespace bramah::bench {

std::string contents(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file + "; bench/run_bench.sh writes it");
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

namespace {

Value parsed(const std::string& text, const std::string& place) {
  Value value;
  Faults faults;
  if (parse_json(text, value, faults) && faults.empty()) return value;
  const Source source{place, text};
  throw std::runtime_error(faults.empty() ? place + ": not JSON" : render(source, SceneError(std::move(faults))));
}

}  // namespace

Value read_json(const std::string& file) { return parsed(contents(file), file); }

std::vector<Value> read_json_lines(const std::string& file) {
  std::istringstream in(contents(file));
  std::vector<Value> list;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) list.push_back(parsed(line, file + ", result " + std::to_string(list.size() + 1)));
  }
  return list;
}

double number(const Value& object, std::string_view key) {
  const Value* member = object.find(key);
  return member != nullptr && member->number() != nullptr ? *member->number() : NAN;
}

std::string text(const Value& object, std::string_view key) {
  const Value* member = object.find(key);
  return member != nullptr && member->text() != nullptr ? *member->text() : std::string();
}

Results::Results(const std::string& stem)
    : lines(read_json_lines(stem + ".workloads.jsonl")),
      micro(read_json(stem + ".json")),
      comparison(read_json(stem + ".compare.json")) {}

std::string Results::context(std::string_view key) const {
  const Value* context = micro.find("context");
  return context == nullptr ? "" : text(*context, key);
}

std::vector<Micro> micro_benchmarks(const Value& file) {
  constexpr double nothing = NAN;
  const Value* list = file.find("benchmarks");
  if (list == nullptr || list->list() == nullptr)
    throw std::runtime_error("a file of Google Benchmark has a list \"benchmarks\"; bench/run_bench.sh writes one");
  const auto unit = [](const std::string& name) { return name == "us" ? 1e-6 : name == "ms" ? 1e-3 : 1e-9; };
  std::vector<Micro> works;
  std::map<std::string, std::size_t> known;
  for (const Value& entry : *list->list()) {
    const std::string name = text(entry, "run_name"), aggregate = text(entry, "aggregate_name");
    if (aggregate != "median" && aggregate != "cv") continue;
    const auto [place, is_new] = known.try_emplace(name, works.size());
    if (is_new) works.push_back({name, nothing, nothing, nothing});
    Micro& work = works[place->second];
    const bool manual = name.ends_with("manual_time");
    const double time = number(entry, manual ? "real_time" : "cpu_time");
    if (aggregate == "median") {
      work.seconds = time * unit(text(entry, "time_unit"));
      work.per_body = number(entry, "per_body");
    } else {
      work.variation = time;
    }
  }
  return works;
}

}  // namespace bramah::bench
