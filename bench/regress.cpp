// What changed between two results: bramah_bench_regress OLD NEW, both NAME.json of Google Benchmark or both
// NAME.workloads.jsonl. Ends with 1 where something has become slower beyond noise, with 2 where it cannot tell.
#include <exception>
#include <iostream>

#include "io/tables.hpp"
#include "regression.hpp"

namespace bramah::bench {
namespace {

int report(const Regression& found) {
  if (found.within_noise + found.changes.size() == 0) {
    std::cerr << "bramah_bench_regress: the two results have no work in common\n";
    return 2;
  }
  Table table;
  table.header = {"work", "before", "after", "ratio", "noise", ""};
  table.right = "lrrrrl";
  for (const Change& change : found.changes) {
    table.rows.push_back({change.name, duration(change.before), duration(change.after), short_number(change.ratio(), 3),
                          short_number(100.0 * change.noise, 2) + " %", change.slower() ? "slower" : "faster"});
  }
  if (!table.rows.empty()) std::cout << as_text(table) << '\n';
  std::cout << found.within_noise << " works within noise, " << found.changes.size() << " beyond it\n";
  for (const std::string& name : found.only_before) std::cout << "only before: " << name << '\n';
  for (const std::string& name : found.only_after) std::cout << "only after:  " << name << '\n';
  return found.slower() ? 1 : 0;
}

}  // namespace
}  // namespace bramah::bench

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: bramah_bench_regress OLD NEW   (two NAME.json, or two NAME.workloads.jsonl)\n";
    return 2;
  }
  try {
    return bramah::bench::report(bramah::bench::changes_between(argv[1], argv[2]));
  } catch (const std::exception& error) {
    std::cerr << "bramah_bench_regress: " << error.what() << '\n';
    return 2;
  }
}
