#include "families.hpp"

#include "solve/equilibrium.hpp"
#include "solve/start.hpp"
#include "support/generators.hpp"

namespace bramah::bench {
namespace {

constexpr double bend = 0.3;  // rad at most, at every joint

const auto four_bar = [](int) { return support::four_bar_scene(); };
const auto planar = [](int links) { return support::planar_chain(links); };
const auto planar_bent = [](int links) { return support::planar_chain(links, support::bent(bend)); };
const auto spatial = [](int links) { return support::spatial_chain(links); };
const auto spatial_bent = [](int links) {
  return support::spatial_chain(links, support::Axes::alternating, support::bent(bend));
};

const auto ladder = [](int loops) { return support::spatial_ladder(loops); };

}  // namespace

Case::Case(std::string family, int size, Scene (*rest)(int), Scene (*general)(int), Extent extent)
    : family_(std::move(family)), size_(size), at_rest_(rest), general_(general), extent_(extent) {}

std::string Case::name() const { return family_ + "/" + std::to_string(size_); }

const Machine& Case::machine() const {
  if (machine_) return *machine_;
  auto machine = std::make_unique<Machine>();
  machine->model = support::compiled(general_(size_));
  const System& system = machine->model.system;
  machine->state = family_ == "four_bar" ? find_equilibrium(system, machine->model.options.equilibrium).state
                                         : consistent_start(system, machine->model.options, 0.0);
  machine->partition = choose_partition(system, machine->state, machine->model.options.linearize.prescribed);
  machine_ = std::move(machine);
  return *machine_;
}

const std::vector<Case>& cases() {
  static const std::vector<Case> all = [] {
    std::vector<Case> list;
    list.emplace_back("four_bar", 3, four_bar, four_bar);
    for (const int links : {10, 100, 1000}) list.emplace_back("planar_chain", links, planar, planar_bent);
    for (const int links : {10, 100, 1000}) list.emplace_back("spatial_chain", links, spatial, spatial_bent);
    using enum Case::Extent;
    // 10^2 to 10^5 coordinates; ladders of 33, 333 and 3333 loops have 100, 1000 and 10 000 hinges in space.
    for (const int links : {33, 333, 3333, 33333})
      list.emplace_back("bent_planar", links, planar_bent, planar_bent, partition);
    for (const int links : {14, 143, 1429, 14286})
      list.emplace_back("bent_spatial", links, spatial_bent, spatial_bent, partition);
    for (const int links : {15, 143, 1429}) list.emplace_back("hanging_spatial", links, spatial, spatial, modes);
    for (const int loops : {33, 333, 3333}) list.emplace_back("spatial_ladder", loops, ladder, ladder, partition);
    return list;
  }();
  return all;
}

}  // namespace bramah::bench
