#include "support/random_machine.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "support/generators.hpp"
#include "support/scene_parts.hpp"

namespace bramah::support {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double pi = std::numbers::pi;
constexpr int most_coordinates = 60;

/// Numbers by lot, the same with every standard library.
class Lot {
 public:
  explicit Lot(std::uint64_t seed) : bits_(seed) {}
  double between(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }
  /// 0, 1, ..., count - 1.
  int pick(int count) { return static_cast<int>(between(0.0, count)); }
  bool chance(double probability) { return between(0.0, 1.0) < probability; }
  /// Low to high, their ratios equally likely.
  double spread(double low, double high) { return low * std::exp(between(0.0, std::log(high / low))); }
  double sign() { return chance(0.5) ? 1.0 : -1.0; }
  Vector3d within(double size) {
    Vector3d v;
    for (int i = 0; i < 3; ++i) v(i) = between(-size, size);
    return v;
  }
  Vector3d direction() {
    for (;;) {
      const Vector3d v = within(1.0);
      if (v.norm() > 0.1 && v.norm() < 1.0) return v.normalized();
    }
  }

 private:
  std::mt19937_64 bits_;
};

/// Nodes tied in pairs; node 0 is what never moves, or a tank.
class Ties {
 public:
  explicit Ties(int nodes) : parent_(static_cast<std::size_t>(nodes)) { std::iota(parent_.begin(), parent_.end(), 0); }
  void tie(int a, int b) { parent_[static_cast<std::size_t>(root(a))] = root(b); }
  [[nodiscard]] bool tied(int a, int b) const { return root(a) == root(b); }
  /// Sets of nodes without node 0.
  [[nodiscard]] int loose() const {
    int count = 0;
    for (int i = 1; i < static_cast<int>(parent_.size()); ++i) count += root(i) == i && !tied(i, 0) ? 1 : 0;
    return count;
  }

 private:
  [[nodiscard]] int root(int i) const {
    while (parent_[static_cast<std::size_t>(i)] != i) i = parent_[static_cast<std::size_t>(i)];
    return i;
  }
  std::vector<int> parent_;
};

Value list(const Vector2d& v) { return support::list({v.x(), v.y()}); }
Value list(const Vector3d& v) { return support::list({v.x(), v.y(), v.z()}); }
using support::list;

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : lot_(seed), seed_(seed) {}

  RandomMachine make() {
    add("ground", {{"type", "mechanics/ground"}});
    add("down_y", {{"type", "mechanics/gravity"}, {"acceleration", list({0, -gravity, 0})}});
    add("down_z", {{"type", "mechanics/gravity"}, {"acceleration", list({0, 0, -gravity})}});
    // What rolls has no equilibrium.
    const bool moving = lot_.chance(0.2);
    const int parts = 1 + lot_.pick(3);
    for (part_ = 1; part_ <= parts && (part_ == 1 || n_ <= most_coordinates - 42); ++part_) {
      if (moving) {
        add_moving();
      } else {
        add_resting();
      }
    }
    RandomMachine machine;
    machine.scene = scene_of("Random machine " + std::to_string(seed_), names({"mechanics", "hydraulics", "friction"}),
                             std::move(components_));
    if (!start_.empty()) machine.scene.root.set("start", std::move(start_));
    machine.scene.root.set("linearize", Value::Object{{"at", moving ? "start" : "equilibrium"}});
    std::sort(blocks_.rbegin(), blocks_.rend());
    machine.zero_blocks = std::move(blocks_);
    return machine;
  }

 private:
  void add_resting() {
    switch (lot_.pick(11)) {
      case 0: return line_of_masses();
      case 1: return planar_links();
      case 2: return spatial_links();
      case 3: return loop(Plane::flat);
      case 4: return loop(Plane::in_space);
      case 5: return hanging_parallelograms(lot_.chance(0.5) ? Plane::flat : Plane::in_space);
      case 6: return door();
      case 7: return volumes();
      case 8: return cylinder_on_mass();
      case 9: return cylinder_on_boom(lot_.chance(0.5) ? Plane::flat : Plane::in_space);
      default: return bushings();
    }
  }
  void add_moving() {
    switch (lot_.pick(5)) {
      case 0: return rolling_disc();
      case 1: return resting_disc();
      case 2: return skate();
      case 3: return resting_wheel();
      default: return top();
    }
  }

  // --- names, components, blocks

  [[nodiscard]] std::string name(const std::string& local) const { return "p" + std::to_string(part_) + "_" + local; }
  void add(std::string component, Value::Object members) {
    components_.push_back({std::move(component), Value(std::move(members))});
  }
  void zeros(int count, int size) { blocks_.insert(blocks_.end(), static_cast<std::size_t>(std::max(count, 0)), size); }
  /// Motions that nothing restores, and those of them that nothing damps either.
  void free_motions(int unrestored, int undamped) {
    zeros(undamped, 2);
    zeros(unrestored - undamped, 1);
  }

  enum class Link { nothing, spring, damper, both };
  Link any_link() { return static_cast<Link>(lot_.pick(4)); }
  static bool springs(Link link) { return link == Link::spring || link == Link::both; }
  static bool damps(Link link) { return link == Link::damper || link == Link::both; }
  /// Stiffness and damping by lot.
  Value::Object spring(const char* type, Link link, std::string to, double stiffness) {
    Value::Object members = {{"type", type}, {"to", std::move(to)}};
    if (springs(link)) members.push_back({"stiffness", stiffness * lot_.spread(0.3, 3.0)});
    if (damps(link)) members.push_back({"damping", 0.1 * stiffness * lot_.spread(0.1, 1.0)});
    return members;
  }

  // --- on a line

  void line_of_masses() {
    const int count = 1 + lot_.pick(8);
    Ties restored(count + 1), held(count + 1);
    const auto note = [&](Link link, int a, int b) {
      if (springs(link)) restored.tie(a, b);
      if (link != Link::nothing) held.tie(a, b);
    };
    std::vector<double> place = {0.0};
    for (int i = 1; i <= count; ++i) {
      place.push_back(place.back() + lot_.between(0.2, 1.0));
      add(name(numbered("m", i)),
          {{"type", "mechanics/mass"}, {"mass", lot_.spread(0.2, 20.0)}, {"position", place.back()}});
      const Link link = any_link();
      if (link == Link::nothing) continue;
      Value::Object between = spring("mechanics/spring_damper", link, name(numbered("m", i)) + ".x", 1000.0);
      if (i > 1) between.push_back({"from", name(numbered("m", i - 1)) + ".x"});
      between.push_back({"free_length", place.back() - place[static_cast<std::size_t>(i) - 1]});
      add(name(numbered("k", i)), std::move(between));
      note(link, i - 1, i);
    }
    if (lot_.chance(0.3)) {
      const int rubbed = 1 + lot_.pick(count);
      add(name("friction"), {{"type", "friction/brown_mcphee"},
                             {"along", name(numbered("m", rubbed)) + ".x"},
                             {"F_c", lot_.spread(1.0, 10.0)},
                             {"F_s", lot_.spread(10.0, 20.0)},
                             {"v_s", lot_.spread(0.1, 1.0)},
                             {"sigma_2", lot_.spread(1.0, 10.0)}});
      note(Link::damper, 0, rubbed);
    }
    free_motions(restored.loose(), held.loose());
    n_ += count;
  }

  // --- chains

  /// Pinned, or adrift in the plane. Without gravity M q'' + C q' + K q = 0 in absolute angles holds in any pose.
  void planar_links() {
    const int count = 1 + lot_.pick(6);
    const bool pinned = lot_.chance(0.7), falls = pinned && lot_.chance(0.5);
    Ties restored(count + 1), held(count + 1);
    Vector2d joint(0.0, 0.0);
    double angle = -0.5 * pi, before = 0.0, half_before = 0.0;
    for (int i = 1; i <= count; ++i) {
      if (!falls) angle += lot_.between(-1.0, 1.0);
      const double half = lot_.between(0.2, 0.8), mass = lot_.spread(0.3, 10.0);
      const Vector2d along(std::cos(angle), std::sin(angle));
      const std::string link = name(numbered("link", i));
      Value::Object body = {{"type", "mechanics/planar_body"},
                            {"mass", mass},
                            {"inertia", mass * half * half * lot_.between(0.2, 0.5)},
                            {"position", list(Vector2d(joint + half * along))},
                            {"angle", angle}};
      if (falls) body.push_back({"gravity", "down_y"});
      add(link, std::move(body));
      if (i > 1 || pinned) {
        add(name(numbered("pin", i)), {{"type", "mechanics/planar_revolute"},
                                       {"a", i == 1 ? std::string("ground") : name(numbered("link", i - 1))},
                                       {"point_a", list({i == 1 ? 0.0 : half_before, 0.0})},
                                       {"b", link},
                                       {"point_b", list({-half, 0.0})}});
        const Link tie = any_link();
        if (tie != Link::nothing) {
          Value::Object torsion = spring("mechanics/torsion_spring", tie, link + ".angle", 20.0);
          if (i > 1) torsion.push_back({"from", name(numbered("link", i - 1)) + ".angle"});
          const double slack = i > 1 ? angle - before : angle;
          torsion.push_back({"free_angle", slack + (falls ? lot_.between(-0.2, 0.2) : 0.0)});
          add(name(numbered("torsion", i)), std::move(torsion));
          if (springs(tie)) restored.tie(i - 1, i);
          held.tie(i - 1, i);
        }
      }
      joint += 2.0 * half * along;
      before = angle;
      half_before = half;
    }
    if (!falls) free_motions(restored.loose(), held.loose());
    if (!pinned) zeros(2, 2);
    n_ += 3 * count;
  }

  /// A body whose axes are turned by lot, so that no Euler parameter is special.
  struct Turned {
    std::string name = {};
    Vector3d centre = Vector3d::Zero();
    Eigen::AngleAxisd turn = Eigen::AngleAxisd::Identity();
    [[nodiscard]] Value point(const Vector3d& at) const { return list(Vector3d(turn.inverse() * (at - centre))); }
    [[nodiscard]] Value axis(const Vector3d& along) const { return list(Vector3d(turn.inverse() * along)); }
  };
  Turned rigid_body(const std::string& local, const Vector3d& centre, double size, const char* field) {
    const Vector3d about = lot_.direction();
    const double by = lot_.between(-2.5, 2.5);
    Turned body{name(local), centre, Eigen::AngleAxisd(by, about)};
    const double mass = lot_.spread(0.3, 10.0);
    Vector3d inertia;
    for (int i = 0; i < 3; ++i) inertia(i) = mass * size * size * lot_.between(0.2, 0.38);
    Value::Object members = {{"type", "mechanics/rigid_body"},
                             {"mass", mass},
                             {"inertia", list(inertia)},
                             {"position", list(centre)},
                             {"rotation", list(Vector3d(by * about))}};
    if (field != nullptr) members.push_back({"gravity", field});
    add(body.name, std::move(members));
    n_ += 7;
    return body;
  }
  static Turned the_ground() {
    Turned ground;
    ground.name = "ground";
    return ground;
  }
  void joint(const std::string& local, const char* type, const Turned& a, const Turned& b, const Vector3d& at,
             const Vector3d& axis_a, const Vector3d& axis_b) {
    Value::Object members = {
        {"type", type}, {"a", a.name}, {"b", b.name}, {"point_a", a.point(at)}, {"point_b", b.point(at)}};
    if (std::string_view(type) != "mechanics/spherical") {
      members.push_back({"axis_a", a.axis(axis_a)});
      members.push_back({"axis_b", b.axis(axis_b)});
    }
    if (std::string_view(type) == "mechanics/prismatic") {
      const Vector3d normal = axis_a.unitOrthogonal();
      members.push_back({"normal_a", a.axis(normal)});
      members.push_back({"normal_b", b.axis(normal)});
    }
    add(name(local), std::move(members));
  }
  /// A length from the ground to a point of a body; what acts along it is slack.
  void spatial_stroke(const std::string& local, const Vector3d& from, const Turned& body, const Vector3d& to) {
    add(name(local), {{"type", "mechanics/stroke"},
                      {"a", "ground"},
                      {"point_a", list(from)},
                      {"b", body.name},
                      {"point_b", body.point(to)},
                      {"length", (to - from).norm()}});
    ++n_;
  }
  void along_stroke(const std::string& local, const std::string& stroke, Link link, double length) {
    Value::Object members = spring("mechanics/spring_damper", link, name(stroke) + ".s", 500.0);
    members.push_back({"free_length", length});
    add(name(local), std::move(members));
  }

  /// Hangs straight down. Gravity restores every tilt; turning about the plumb line and sliding level change nothing.
  void spatial_links() {
    const int count = 1 + lot_.pick(5);
    const bool falls = lot_.chance(0.7);
    const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
    int motions = 0, level = 0;
    Vector3d at = Vector3d::Zero();
    Turned before = the_ground();
    for (int i = 1; i <= count; ++i) {
      const double half = lot_.between(0.2, 0.6);
      const Turned body = rigid_body(numbered("link", i), at - half * z, half, falls ? "down_z" : nullptr);
      const double heading = lot_.between(-pi, pi);
      const Vector3d across(std::cos(heading), std::sin(heading), 0.0);
      const auto hold = [&](const char* type, const Vector3d& axis_a, const Vector3d& axis_b, int all, int free) {
        joint(numbered("joint", i), type, before, body, at, axis_a, axis_b);
        motions += all;
        level += free;
      };
      switch (lot_.pick(i == 1 ? 6 : 4)) {
        case 0: hold("mechanics/revolute", across, across, 1, 0); break;
        case 1: hold("mechanics/revolute", z, z, 1, 1); break;
        case 2: hold("mechanics/spherical", x, y, 3, 1); break;
        case 3: hold("mechanics/universal", across, z.cross(across), 2, 0); break;
        case 4: hold("mechanics/cylindrical", across, across, 2, 1); break;
        default: hold("mechanics/prismatic", across, across, 1, 1); break;
      }
      at -= 2.0 * half * z;
      before = body;
    }
    const int free = falls ? level : motions;
    const Link link = any_link();
    if (link == Link::nothing) return free_motions(free, free);
    // One length, in general position, takes one motion out of those that are free.
    const Vector3d to = at + Vector3d(0.2, 0.1, 0.1);
    const Vector3d from = to + Vector3d{lot_.between(0.3, 0.8), lot_.between(-0.8, -0.3), lot_.between(0.3, 0.8)};
    spatial_stroke("tie", from, before, to);
    along_stroke("tie_spring", "tie", link, (to - from).norm());
    const int others = std::max(free - 1, 0);
    free_motions(springs(link) ? others : free, others);
  }

  // --- bars in a plane, of planar bodies or, as planes go, anywhere in space

  enum class Plane { flat, in_space };
  struct Bar {
    Turned body;  // in space
    Vector2d centre;
    double angle = 0.0;
  };
  /// A vertical plane through the origin; y of the plane points up.
  struct Frame {
    Plane plane = Plane::flat;
    Vector3d ahead = Vector3d::UnitX();
    [[nodiscard]] Vector3d place(const Vector2d& p) const { return p.x() * ahead + p.y() * Vector3d::UnitZ(); }
    [[nodiscard]] Vector3d normal() const { return ahead.cross(Vector3d::UnitZ()); }
  };
  Frame frame(Plane plane) {
    const double heading = lot_.between(-pi, pi);
    return {plane, Vector3d(std::cos(heading), std::sin(heading), 0.0)};
  }
  Bar bar(const Frame& frame, const std::string& local, const Vector2d& from, const Vector2d& to, bool falls) {
    const Vector2d along = to - from;
    Bar made{{}, 0.5 * (from + to), std::atan2(along.y(), along.x())};
    if (frame.plane == Plane::in_space) {
      made.body = rigid_body(local, frame.place(made.centre), 0.5 * along.norm(), falls ? "down_z" : nullptr);
      return made;
    }
    const double mass = lot_.spread(0.3, 10.0);
    made.body.name = name(local);
    Value::Object members = {{"type", "mechanics/planar_body"},
                             {"mass", mass},
                             {"inertia", mass * along.squaredNorm() * lot_.between(0.05, 0.12)},
                             {"position", list(made.centre)},
                             {"angle", made.angle}};
    if (falls) members.push_back({"gravity", "down_y"});
    add(made.body.name, std::move(members));
    n_ += 3;
    return made;
  }
  static Bar ground_bar() { return {the_ground(), Vector2d::Zero(), 0.0}; }
  static Value flat_point(const Bar& bar, const Vector2d& at) {
    return list(Vector2d(Eigen::Rotation2Dd(-bar.angle) * (at - bar.centre)));
  }
  void pin(const Frame& frame, const std::string& local, const Bar& a, const Bar& b, const Vector2d& at) {
    if (frame.plane == Plane::in_space)
      return joint(local, "mechanics/revolute", a.body, b.body, frame.place(at), frame.normal(), frame.normal());
    add(name(local), {{"type", "mechanics/planar_revolute"},
                      {"a", a.body.name},
                      {"point_a", flat_point(a, at)},
                      {"b", b.body.name},
                      {"point_b", flat_point(b, at)}});
  }
  void stroke(const Frame& frame, const std::string& local, const Vector2d& from, const Bar& bar, const Vector2d& to) {
    if (frame.plane == Plane::in_space) return spatial_stroke(local, frame.place(from), bar.body, frame.place(to));
    add(name(local), {{"type", "mechanics/planar_stroke"},
                      {"a", "ground"},
                      {"point_a", list(from)},
                      {"b", bar.body.name},
                      {"point_b", flat_point(bar, to)},
                      {"length", (to - from).norm()}});
    ++n_;
  }

  /// A closed polygon of 4 to 6 bars, one of them the ground; in space each repeats three rows. No gravity, so that
  /// it rests in any pose; what acts is slack.
  void loop(Plane plane) {
    const Frame frame = this->frame(plane);
    const int bars = 3 + lot_.pick(3), motions = bars - 2;
    std::vector<Vector2d> corner;
    for (int i = 0; i <= bars; ++i) {
      const double angle = pi + (i + lot_.between(-0.25, 0.25)) * 2.0 * pi / (bars + 1),
                   radius = lot_.between(0.6, 1.4);
      corner.push_back(radius * Vector2d(std::cos(angle), std::sin(angle)));
    }
    const auto at = [&](int i) { return corner[static_cast<std::size_t>(i)]; };
    Bar before = ground_bar(), first = before, second = before;
    for (int i = 0; i < bars; ++i) {
      const Bar next = bar(frame, numbered("bar", i + 1), at(i), at(i + 1), false);
      pin(frame, numbered("pin", i + 1), before, next, at(i));
      before = next;
      if (i == 0) first = next;
      if (i == 1) second = next;
    }
    pin(frame, numbered("pin", bars + 1), before, ground_bar(), at(bars));
    int restored = 0, damped = 0;
    if (lot_.chance(0.5)) {
      const Vector2d from = at(1) + 0.7 * Vector2d(at(1) - at(0)).unitOrthogonal();
      stroke(frame, "strut", from, first, at(1));
      along_stroke("strut_spring", "strut", lot_.chance(0.5) ? Link::spring : Link::both, (at(1) - from).norm());
      restored = 1;
    }
    if (lot_.chance(0.5)) {
      const Vector2d from = at(2) + 0.7 * (at(2) - at(0)).normalized();
      stroke(frame, "dashpot", from, second, at(2));
      along_stroke("dashpot_damper", "dashpot", Link::damper, (at(2) - from).norm());
      damped = 1;
    }
    free_motions(motions - restored, std::max(motions - restored - damped, 0));
  }

  /// Uprights that hang, equally long, and a bar across every neighbouring pair: one motion, which gravity restores.
  void hanging_parallelograms(Plane plane) {
    const Frame frame = this->frame(plane);
    const int loops = 1 + lot_.pick(2);
    const double length = lot_.between(0.5, 1.5);
    Vector2d top(0.0, 0.0);
    Bar before = ground_bar();
    for (int i = 0; i <= loops; ++i) {
      const Vector2d last = top - Vector2d(0.0, length);
      if (i > 0) top.x() += lot_.between(0.4, 1.2);
      const Vector2d low = top - Vector2d(0.0, length);
      const Bar upright = bar(frame, numbered("upright", i), top, low, true);
      pin(frame, numbered("hung", i), ground_bar(), upright, top);
      if (i > 0) {
        const Bar across = bar(frame, numbered("across", i), last, low, true);
        pin(frame, numbered("left", i), before, across, last);
        pin(frame, numbered("right", i), across, upright, low);
      }
      before = upright;
    }
  }

  /// One axis, one to four hinges on it.
  void door() {
    const Vector3d axis = lot_.direction(), out = axis.unitOrthogonal();
    const double width = lot_.between(0.2, 0.8), tilt = lot_.between(0.1, 0.5 * pi);
    const int lies = lot_.pick(3);  // 0: gravity pulls it shut; 1: gravity along the axis; 2: no gravity
    if (lies < 2) {
      const Vector3d pull = lies == 0 ? Vector3d(std::sin(tilt) * out + std::cos(tilt) * axis) : axis;
      add(name("field"), {{"type", "mechanics/gravity"}, {"acceleration", list(Vector3d(gravity * pull))}});
    }
    const std::string field = name("field");
    const Turned leaf = rigid_body("leaf", width * out, width, lies < 2 ? field.c_str() : nullptr);
    const int hinges = 1 + lot_.pick(4);
    for (int i = 1; i <= hinges; ++i) {
      const Vector3d at = (0.4 * i + lot_.between(0.0, 0.3)) * axis;
      joint(numbered("hinge", i), "mechanics/revolute", the_ground(), leaf, at, axis, axis);
    }
    if (lies > 0) free_motions(1, 1);
  }

  void bushings() {
    const int count = 1 + lot_.pick(2);
    const Link link = any_link();
    const Vector2d centre(lot_.between(-1.0, 1.0), 0.3);
    const double angle = lot_.between(-pi, pi);
    add(name("block"), {{"type", "mechanics/planar_body"},
                        {"mass", lot_.spread(0.5, 20.0)},
                        {"inertia", lot_.spread(0.1, 2.0)},
                        {"position", list(centre)},
                        {"angle", angle}});
    n_ += 3;
    for (int i = 1; i <= count && link != Link::nothing; ++i) {
      const Vector2d in_body = (i == 1 ? 1.0 : -1.0) * Vector2d{lot_.between(0.2, 0.5), lot_.between(0.2, 0.5)};
      Value::Object members = {{"type", "mechanics/planar_bushing"},
                               {"a", "ground"},
                               {"point_a", list(Vector2d(centre + Eigen::Rotation2Dd(angle) * in_body))},
                               {"b", name("block")},
                               {"point_b", list(in_body)}};
      if (springs(link)) members.push_back({"stiffness", list({lot_.spread(100, 1000), lot_.spread(100, 1000)})});
      if (damps(link)) members.push_back({"damping", list({lot_.spread(1, 20), lot_.spread(1, 20)})});
      add(name(numbered("bushing", i)), std::move(members));
    }
    // One bushing holds a point, two hold the body.
    const int held = count == 1 ? 2 : 3;
    free_motions(springs(link) ? 3 - held : 3, link == Link::nothing ? 3 : 3 - held);
  }

  // --- oil

  void volume(const std::string& local, double pressure) {
    add(name(local), {{"type", "hydraulics/volume"}});
    start_.push_back({name(local) + ".p", pressure});
  }
  void hose(const std::string& local, const std::string& volume) {
    add(name(local), {{"type", "hydraulics/hose"},
                      {"volume", name(volume)},
                      {"V_h", lot_.spread(2e-5, 5e-4)},
                      {"B_h", 5.5e8},
                      {"B_oil", 1.5e9}});
  }
  void passage(const std::string& local, const std::string& a, const std::string& b) {
    if (lot_.chance(0.5)) {
      add(name(local),
          {{"type", "hydraulics/leakage"}, {"a", name(a)}, {"b", name(b)}, {"C_L", lot_.spread(1e-12, 1e-10)}});
    } else {
      add(name(local), {{"type", "hydraulics/throttle"},
                        {"a", name(a)},
                        {"b", name(b)},
                        {"C_d", 0.8},
                        {"A_t", lot_.spread(1e-7, 1e-5)},
                        {"rho_oil", 850}});
    }
  }
  void tank(double pressure) { add(name("tank"), {{"type", "hydraulics/pressure_source"}, {"p", pressure}}); }

  void volumes() {
    const int count = 1 + lot_.pick(8);
    const double pressure = lot_.spread(1e5, 1e7);
    tank(pressure);
    add(name("pump"), {{"type", "hydraulics/pressure_source"}, {"p", pressure * lot_.between(1.0, 1.5)}});
    Ties open(count + 1);
    for (int i = 1; i <= count; ++i) {
      volume(numbered("V", i), pressure);
      hose(numbered("hose", i), numbered("V", i));
    }
    for (int i = 1; i <= count; ++i) {
      if (lot_.chance(0.3)) continue;
      const int to = lot_.pick(count + 1);
      if (to == i) continue;
      const bool pumped = to == 0 && lot_.chance(0.3);
      passage(numbered("passage", i), numbered("V", i), to > 0 ? numbered("V", to) : pumped ? "pump" : "tank");
      open.tie(i, to);
    }
    zeros(open.loose(), 1);
  }

  struct Cylinder {
    int closed = 0;             // closed sets of volumes
    bool moves_closed = false;  // a stroke changes the content of one
  };
  /// Two chambers, each closed, open to the other or to a tank at pressure 0: no force at the start.
  Cylinder cylinder(const std::string& stroke, double length) {
    const bool same_areas = lot_.chance(0.2);
    const double D_2 = lot_.spread(0.02, 0.1), D_3 = same_areas ? 0.0 : D_2 * lot_.between(0.3, 0.7);
    const double area_ratio = 1.0 - D_3 * D_3 / (D_2 * D_2);
    Ties open(3);
    tank(0.0);
    if (lot_.chance(0.3)) {
      passage("across", "head", "rod");
      open.tie(1, 2);
    }
    for (int side = 1; side <= 2; ++side) {
      if (!lot_.chance(0.3)) continue;
      passage(numbered("out", side), side == 1 ? "head" : "rod", "tank");
      open.tie(side, 0);
    }
    const double pressure = open.loose() == 2 ? lot_.spread(1e5, 5e6) : 0.0;
    volume("head", pressure * area_ratio);
    volume("rod", pressure);
    if (lot_.chance(0.5)) hose("hose", "head");
    add(name("cylinder"), {{"type", "hydraulics/cylinder"},
                           {"stroke", stroke},
                           {"piston_side", name("head")},
                           {"rod_side", name("rod")},
                           {"D_2", D_2},
                           {"D_3", D_3},
                           {"l", 1.5 * length},
                           {"c_1", length * lot_.between(0.1, 0.8)},
                           {"B_oil", 1.5e9},
                           {"B_c", 3.15e10}});
    const bool balanced = same_areas && open.tied(1, 2);  // what leaves one chamber enters the other
    return {open.loose(), open.loose() > 0 && !balanced};
  }

  void cylinder_on_mass() {
    const double place = lot_.between(0.5, 1.5);
    add(name("mass"), {{"type", "mechanics/mass"}, {"mass", lot_.spread(1.0, 500.0)}, {"position", place}});
    ++n_;
    const Link link = any_link();
    if (link != Link::nothing) {
      Value::Object members = spring("mechanics/spring_damper", link, name("mass") + ".x", 1e5);
      members.push_back({"free_length", place});
      add(name("spring"), std::move(members));
    }
    const Cylinder oil = cylinder(name("mass") + ".x", place);
    zeros(oil.closed, 1);
    // A free mass stays where oil lets it flow to; the passages damp it.
    if (!springs(link) && !oil.moves_closed) zeros(1, 1);
  }

  /// A boom that hangs; its weight restores.
  void cylinder_on_boom(Plane plane) {
    const Frame frame = this->frame(plane);
    const double length = lot_.between(1.0, 2.5);
    const Vector2d tip(0.0, -length), from{lot_.between(0.4, 1.0), lot_.between(-0.3, 0.3)}, to = 0.6 * tip;
    const Bar boom = bar(frame, "boom", Vector2d::Zero(), tip, true);
    pin(frame, "pin", ground_bar(), boom, Vector2d::Zero());
    stroke(frame, "stroke", from, boom, to);
    zeros(cylinder(name("stroke") + ".s", (to - from).norm()).closed, 1);
  }

  // --- what rolls, skates and spins

  struct Disc {
    double mass, A, C, a, rho;
  };
  Disc disc() {
    Disc d{};
    d.mass = lot_.spread(0.5, 20.0);
    d.a = lot_.between(0.15, 0.6);
    d.rho = lot_.chance(0.5) ? 0.0 : d.a * lot_.between(0.05, 0.3);
    const double share = lot_.between(0.5, 1.0);  // 1/2 for a disc, 1 for a hoop
    d.C = share * d.mass * d.a * d.a;
    d.A = 0.5 * d.C * lot_.between(1.0, 1.1);
    return d;
  }
  void add_disc(const Disc& d, double spin_rate, const char* field) {
    const double yaw = lot_.between(-pi, pi), spin = lot_.between(-pi, pi);
    Value::Object members = {{"type", "mechanics/rolling_disc"},
                             {"mass", d.mass},
                             {"A", d.A},
                             {"C", d.C},
                             {"a", d.a},
                             {"rho", d.rho},
                             {"yaw", yaw},
                             {"spin", spin},
                             {"spin_rate", spin_rate}};
    if (field != nullptr) members.push_back({"gravity", field});
    add(name("wheel"), std::move(members));
    n_ += 6;
  }
  /// Straight ahead, faster than it topples: lambda^2 = (m g a - C (C + m R^2) w^2 / A) / (A + m R^2), R = a + rho.
  /// A turn at constant rate takes the heading with it and that the place, sideways: size 3; a change of speed takes
  /// the spin and the place ahead: size 2, and these two also move by themselves: size 1.
  void rolling_disc() {
    const Disc d = disc();
    const double R = d.a + d.rho;
    const double critical = std::sqrt(d.mass * gravity * d.a * d.A / (d.C * (d.C + d.mass * R * R)));
    const double faster = lot_.between(1.2, 3.0), forth = lot_.sign();
    add_disc(d, forth * faster * critical, "down_z");
    zeros(1, 3);
    free_motions(2, 1);
  }
  /// Without gravity: yaw, lean and spin are free, x and y integrate.
  void resting_disc() {
    add_disc(disc(), 0.0, nullptr);
    free_motions(5, 3);
  }
  /// The same as a rigid body that rolls.
  void resting_wheel() {
    const double a = lot_.between(0.15, 0.6), rho = lot_.chance(0.5) ? 0.0 : a * lot_.between(0.05, 0.3);
    const double heading = lot_.between(-pi, pi), tilt = lot_.between(-0.6, 0.6);
    const Vector3d level(std::cos(heading), std::sin(heading), 0.0);
    const Vector3d axle = std::cos(tilt) * level + std::sin(tilt) * Vector3d::UnitZ();
    const Turned body = rigid_body("wheel", Vector3d(0.3, -0.2, a * std::cos(tilt) + rho), a, nullptr);
    add(name("contact"), {{"type", "mechanics/rolling_wheel"},
                          {"carrier", body.name},
                          {"point", list({0, 0, 0})},
                          {"axle", body.axis(axle)},
                          {"a", a},
                          {"rho", rho}});
    free_motions(5, 3);
  }

  /// A body on an edge, at rest or straight ahead. It moves ahead, turns, and integrates both sideways.
  void skate() {
    const bool ahead = lot_.chance(0.6);
    const double heading = lot_.between(-pi, pi), speed = ahead ? lot_.between(0.5, 5.0) : 0.0;
    const double trail = ahead && lot_.chance(0.5) ? lot_.between(0.1, 0.6) : 0.0;  // of the edge behind the centre
    add(name("skate"), {{"type", "mechanics/planar_body"},
                        {"mass", lot_.spread(1.0, 80.0)},
                        {"inertia", lot_.spread(0.1, 10.0)},
                        {"angle", heading},
                        {"velocity", list({speed * std::cos(heading), speed * std::sin(heading)})}});
    add(name("edge"), {{"type", "mechanics/knife_edge"}, {"body", name("skate")}, {"point", list({-trail, 0.0})}});
    n_ += 3;
    // An edge that trails damps the turn, m d v / (I + m d^2).
    const Link link = trail == 0.0 ? any_link() : Link::nothing;
    if (link != Link::nothing) {
      Value::Object members = spring("mechanics/torsion_spring", link, name("skate") + ".angle", 50.0);
      members.push_back({"free_angle", heading});
      add(name("torsion"), std::move(members));
    }
    const bool dragged = !ahead && lot_.chance(0.5);
    if (dragged) {
      add(name("drag"),
          {{"type", "mechanics/planar_traction"}, {"on", name("skate")}, {"c_d", lot_.spread(1.0, 50.0)}});
    }
    zeros(1, dragged ? 1 : 2);  // ahead
    // A heading integrates to the place sideways when it goes ahead, else the place is a zero of its own.
    const int turn = springs(link) ? 0 : damps(link) || trail > 0.0 ? 1 : 2;
    if (ahead) {
      zeros(1, turn + 1);
    } else {
      zeros(1, 1);
      if (turn > 0) zeros(1, turn);
    }
  }

  /// A rotor on a stem, hanging or, fast enough, standing: C w > 2 sqrt(A m g h). Its spin is free.
  void top() {
    const bool stands = lot_.chance(0.5);
    const double stem_mass = 0.1, stem_inertia = 2e-4, rotor_mass = lot_.between(0.3, 1.0), h = lot_.between(0.04, 0.1);
    const double A = lot_.between(2e-4, 4e-4), C = A * lot_.between(1.2, 1.9), up = stands ? h : -h;
    const double A_tip = A + stem_inertia + (rotor_mass + stem_mass) * h * h;
    const double critical = 2.0 * std::sqrt(A_tip * (rotor_mass + stem_mass) * gravity * h) / C;
    const double rate = stands ? critical * lot_.between(1.2, 3.0) : critical * lot_.between(0.0, 2.0);
    const double forth = lot_.sign();
    add(name("stem"), {{"type", "mechanics/rigid_body"},
                       {"gravity", "down_z"},
                       {"mass", stem_mass},
                       {"inertia", list({stem_inertia, stem_inertia, 1e-6})},
                       {"position", list({0, 0, up})}});
    add(name("rotor"), {{"type", "mechanics/wheel"},
                        {"gravity", "down_z"},
                        {"carrier", name("stem")},
                        {"axle", list({0, 0, 1})},
                        {"mass", rotor_mass},
                        {"A", A},
                        {"C", C},
                        {"rate", forth * rate}});
    add(name("tip"),
        {{"type", "mechanics/universal"}, {"a", "ground"}, {"b", name("stem")}, {"point_b", list({0, 0, -up})}});
    n_ += 8;
    free_motions(1, 1);
  }

  Lot lot_;
  std::uint64_t seed_;
  int part_ = 1, n_ = 0;
  Value::Object components_, start_;
  std::vector<int> blocks_;
};

}  // namespace

RandomMachine random_machine(std::uint64_t seed) { return Maker(seed).make(); }

}  // namespace bramah::support
