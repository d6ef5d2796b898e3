#include "support/generators.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "io/json_writer.hpp"
#include "io/read_scene.hpp"
#include "support/scene_parts.hpp"

namespace bramah::support {
namespace {

using Point = std::array<double, 3>;
using Quaternion = std::array<double, 4>;

Value::Object surroundings(Value acceleration) {
  return {{"ground", Value::Object{{"type", "mechanics/ground"}}},
          {"gravity", Value::Object{{"type", "mechanics/gravity"}, {"acceleration", std::move(acceleration)}}}};
}

/// A rod whose x-axis runs along it, at `angle` from the x-axis of the ground.
Value planar_rod(double x, double y, double angle) {
  return Value::Object{{"type", "mechanics/planar_body"}, {"gravity", "gravity"},     {"mass", rod_mass},
                       {"inertia", rod_inertia},          {"position", list({x, y})}, {"angle", angle}};
}
Value planar_revolute(std::string a, Value point_a, std::string b, Value point_b) {
  return Value::Object{{"type", "mechanics/planar_revolute"},
                       {"a", std::move(a)},
                       {"point_a", std::move(point_a)},
                       {"b", std::move(b)},
                       {"point_b", std::move(point_b)}};
}

struct PlanarPlace {
  double x = 0.0, y = 0.0, angle = 0.0;
  [[nodiscard]] std::array<double, 2> at(double along, double across) const {
    return {x + along * std::cos(angle) - across * std::sin(angle),
            y + along * std::sin(angle) + across * std::cos(angle)};
  }
};

/// Adds links and joints; returns where the links are.
std::vector<PlanarPlace> add_planar_chain(Value::Object& components, int links, const Shape& shape) {
  constexpr double half = 0.5 * rod_length;
  std::vector<PlanarPlace> places;
  std::array<double, 2> joint = {0.0, 0.0};
  double angle = -0.5 * std::numbers::pi;
  for (int i = 1; i <= links; ++i) {
    angle += shape(i);
    const PlanarPlace place{joint[0] + half * std::cos(angle), joint[1] + half * std::sin(angle), angle};
    joint = place.at(half, 0.0);
    places.push_back(place);
    components.push_back({numbered("link_", i), planar_rod(place.x, place.y, place.angle)});
    components.push_back(
        {numbered("joint_", i),
         i == 1 ? planar_revolute("ground", list({0, 0}), "link_1", list({-half, 0}))
                : planar_revolute(numbered("link_", i - 1), list({half, 0}), numbered("link_", i), list({-half, 0}))});
  }
  return places;
}

Quaternion product(const Quaternion& p, const Quaternion& q) {
  return {p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
          p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1], p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]};
}
/// The body's z-axis in ground axes.
Point z_axis(const Quaternion& q) {
  return {2.0 * (q[1] * q[3] + q[0] * q[2]), 2.0 * (q[2] * q[3] - q[0] * q[1]),
          1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2])};
}
/// Axis times angle.
Value rotation_vector(const Quaternion& q) {
  const double sine = std::hypot(q[1], q[2], q[3]);
  const double factor = sine > 0.0 ? 2.0 * std::atan2(sine, q[0]) / sine : 0.0;
  return list({factor * q[1], factor * q[2], factor * q[3]});
}

}  // namespace

double hanging(int) { return 0.0; }

Shape bent(double amplitude) {
  return [amplitude](int joint) { return amplitude * std::cos(1.7 * joint); };
}

Scene four_bar_scene() { return read_scene(std::string(BRAMAH_SOURCE_DIR) + "/scenes/four_bar/overdamped.json"); }

Scene planar_chain(int links, const Shape& shape) {
  Value::Object components = surroundings(list({0, -gravity, 0}));
  add_planar_chain(components, links, shape);
  return scene_of("Planar chain of " + std::to_string(links) + " links", names({"mechanics"}), std::move(components));
}

Scene spatial_chain(int links, Axes axes, const Shape& shape) {
  constexpr double half = 0.5 * rod_length;
  Value::Object components = surroundings(list({0, 0, -gravity}));
  Point joint = {};
  Quaternion orientation = {1, 0, 0, 0};
  for (int i = 1; i <= links; ++i) {
    const bool about_x = axes == Axes::alternating && i % 2 == 0;
    const double sine = std::sin(0.5 * shape(i)), cosine = std::cos(0.5 * shape(i));
    orientation = product(orientation, about_x ? Quaternion{cosine, sine, 0, 0} : Quaternion{cosine, 0, sine, 0});
    const Point up = z_axis(orientation);
    components.push_back(
        {numbered("link_", i),
         Value::Object{{"type", "mechanics/rigid_body"},
                       {"gravity", "gravity"},
                       {"mass", rod_mass},
                       {"inertia", list({rod_inertia, rod_inertia, 0})},
                       {"position", list({joint[0] - half * up[0], joint[1] - half * up[1], joint[2] - half * up[2]})},
                       {"rotation", rotation_vector(orientation)}}});
    for (std::size_t k = 0; k < 3; ++k) joint[k] -= rod_length * up[k];
    const auto axis = [&] { return about_x ? list({1, 0, 0}) : list({0, 1, 0}); };
    components.push_back(
        {numbered("joint_", i), Value::Object{{"type", "mechanics/revolute"},
                                              {"a", i == 1 ? std::string("ground") : numbered("link_", i - 1)},
                                              {"point_a", list({0, 0, i == 1 ? 0.0 : -half})},
                                              {"axis_a", axis()},
                                              {"b", numbered("link_", i)},
                                              {"point_b", list({0, 0, half})},
                                              {"axis_b", axis()}}});
  }
  return scene_of("Spatial chain of " + std::to_string(links) + " links", names({"mechanics"}), std::move(components));
}

Scene hydraulic_chain(int links, int every, const Shape& shape) {
  constexpr double half = 0.5 * rod_length, offset = 0.1 * rod_length;  // lever of a cylinder
  Value::Object components = surroundings(list({0, -gravity, 0}));
  const std::vector<PlanarPlace> places = add_planar_chain(components, links, shape);
  Value::Object start;
  Value::List hold;
  for (int i = 1; i <= links; i += every) {
    // From centre to centre, beside the joint; from the ground where a link above joint 1 would have its centre.
    const std::array<double, 2> from =
        i == 1 ? std::array{offset, half} : places[static_cast<std::size_t>(i) - 2].at(0.0, offset);
    const std::array<double, 2> to = places[static_cast<std::size_t>(i) - 1].at(0.0, offset);
    const std::string piston = numbered("piston_", i), head = numbered("head_", i), rod = numbered("rod_", i);
    components.push_back({piston, Value::Object{{"type", "mechanics/planar_stroke"},
                                                {"a", i == 1 ? std::string("ground") : numbered("link_", i - 1)},
                                                {"point_a", i == 1 ? list({offset, half}) : list({0, offset})},
                                                {"b", numbered("link_", i)},
                                                {"point_b", list({0, offset})},
                                                {"length", std::hypot(to[0] - from[0], to[1] - from[1])}}});
    for (const std::string& volume : {head, rod}) {
      components.push_back({volume, Value::Object{{"type", "hydraulics/volume"}}});
      components.push_back(
          {"hose_" + volume,
           Value::Object{
               {"type", "hydraulics/hose"}, {"volume", volume}, {"V_h", 1e-4}, {"B_h", 5.5e8}, {"B_oil", 1.5e9}}});
      start.push_back({volume + ".p", 1e5});
    }
    components.push_back({numbered("cylinder_", i), Value::Object{{"type", "hydraulics/cylinder"},
                                                                  {"stroke", piston + ".s"},
                                                                  {"piston_side", head},
                                                                  {"rod_side", rod},
                                                                  {"D_2", 0.05},
                                                                  {"D_3", 0.005},
                                                                  {"l", 1.3},
                                                                  {"c_1", 0.3},
                                                                  {"c_2", 0.05},
                                                                  {"B_oil", 1.5e9},
                                                                  {"B_c", 3.15e10}}});
    components.push_back(
        {numbered("throttle_", i),
         Value::Object{
             {"type", "hydraulics/throttle"}, {"a", head}, {"b", rod}, {"C_d", 0.8}, {"A_t", 1e-6}, {"rho_oil", 850}}});
    hold.emplace_back(rod + ".p");
  }
  Scene scene = scene_of("Planar chain of " + std::to_string(links) + " links with cylinders",
                         names({"mechanics", "hydraulics"}), std::move(components));
  scene.root.set("start", std::move(start));
  scene.root.set("hold", std::move(hold));
  return scene;
}

Scene four_bar_ladder(int loops) {
  constexpr double half = 0.5 * rod_length, upper_end_speed = 1.0;
  Value::Object components = surroundings(list({0, -gravity, 0}));
  int joint = 0;
  const auto connect = [&](Value revolute) {
    components.push_back({numbered("joint_", ++joint), std::move(revolute)});
  };
  for (int i = 0; i <= loops; ++i) {
    const std::string upright = numbered("upright_", i);
    Value rod = planar_rod(i * rod_length, half, 0.5 * std::numbers::pi);
    rod.set("velocity", list({0.5 * upper_end_speed, 0}));
    rod.set("angular_velocity", -upper_end_speed / rod_length);
    components.push_back({upright, std::move(rod)});
    connect(planar_revolute("ground", list({i * rod_length, 0}), upright, list({-half, 0})));
    if (i == 0) continue;
    const std::string across = numbered("across_", i);
    Value coupler = planar_rod((i - 0.5) * rod_length, rod_length, 0.0);
    coupler.set("velocity", list({upper_end_speed, 0}));
    components.push_back({across, std::move(coupler)});
    connect(planar_revolute(numbered("upright_", i - 1), list({half, 0}), across, list({-half, 0})));
    connect(planar_revolute(across, list({half, 0}), upright, list({half, 0})));
  }
  return scene_of("Ladder of " + std::to_string(loops) + " four-bars", names({"mechanics"}), std::move(components));
}

Scene spatial_ladder(int loops) {
  constexpr double half = 0.5 * rod_length;
  Value::Object components = surroundings(list({0, 0, -gravity}));
  int joint = 0;
  const auto connect = [&](std::string a, Value point_a, std::string b, Value point_b) {
    components.push_back({numbered("joint_", ++joint), Value::Object{{"type", "mechanics/revolute"},
                                                                     {"a", std::move(a)},
                                                                     {"point_a", std::move(point_a)},
                                                                     {"axis_a", list({0, 1, 0})},
                                                                     {"b", std::move(b)},
                                                                     {"point_b", std::move(point_b)},
                                                                     {"axis_b", list({0, 1, 0})}}});
  };
  const auto rod = [&](const std::string& name, Value inertia, Value position) {
    components.push_back({name, Value::Object{{"type", "mechanics/rigid_body"},
                                              {"gravity", "gravity"},
                                              {"mass", rod_mass},
                                              {"inertia", std::move(inertia)},
                                              {"position", std::move(position)}}});
  };
  for (int i = 0; i <= loops; ++i) {
    const std::string upright = numbered("upright_", i);
    rod(upright, list({rod_inertia, rod_inertia, 0}), list({i * rod_length, 0, half}));
    connect("ground", list({i * rod_length, 0, 0}), upright, list({0, 0, -half}));
    if (i == 0) continue;
    const std::string across = numbered("across_", i);
    rod(across, list({0, rod_inertia, rod_inertia}), list({(i - 0.5) * rod_length, 0, rod_length}));
    connect(numbered("upright_", i - 1), list({0, 0, half}), across, list({-half, 0, 0}));
    connect(across, list({half, 0, 0}), upright, list({0, 0, half}));
  }
  return scene_of("Ladder of " + std::to_string(loops) + " four-bars in space", names({"mechanics"}),
                  std::move(components));
}

Scene cylinder_manifold(int cylinders) {
  constexpr double pressure = 5e6, rho_oil = 850.0, feed_area = 2e-6, branch_area = 1e-6, rail_hose = 2e-4;
  const auto hose = [](const std::string& volume, double V_h) {
    return Value::Object{
        {"type", "hydraulics/hose"}, {"volume", volume}, {"V_h", V_h}, {"B_h", 5.5e8}, {"B_oil", 1.5e9}};
  };
  const auto throttle = [](const std::string& a, const std::string& b, double area) {
    return Value::Object{
        {"type", "hydraulics/throttle"}, {"a", a}, {"b", b}, {"C_d", 0.8}, {"A_t", area}, {"rho_oil", rho_oil}};
  };
  Value::Object components = {{"pump", Value::Object{{"type", "hydraulics/pressure_source"}, {"p", pressure}}},
                              {"tank", Value::Object{{"type", "hydraulics/pressure_source"}, {"p", 0.0}}},
                              {"rail", Value::Object{{"type", "hydraulics/volume"}}},
                              {"rail_hose", hose("rail", cylinders * rail_hose)},
                              {"feed", throttle("pump", "rail", cylinders * feed_area)}};
  Value::Object start = {{"rail.p", pressure}};
  for (int i = 1; i <= cylinders; ++i) {
    const std::string load = numbered("load_", i), head = numbered("head_", i);
    components.push_back({load, Value::Object{{"type", "mechanics/mass"}, {"mass", 100.0}, {"position", 0.75}}});
    components.push_back({numbered("spring_", i), Value::Object{{"type", "mechanics/spring_damper"},
                                                                {"to", load + ".x"},
                                                                {"stiffness", 1e6},
                                                                {"damping", 1e3},
                                                                {"free_length", 0.74}}});
    components.push_back({head, Value::Object{{"type", "hydraulics/volume"}}});
    components.push_back({numbered("hose_", i), hose(head, 1e-4)});
    components.push_back({numbered("throttle_", i), throttle("rail", head, branch_area)});
    components.push_back({numbered("cylinder_", i), Value::Object{{"type", "hydraulics/cylinder"},
                                                                  {"stroke", load + ".x"},
                                                                  {"piston_side", head},
                                                                  {"rod_side", "tank"},
                                                                  {"D_2", 0.05},
                                                                  {"D_3", 0.03},
                                                                  {"l", 0.5},
                                                                  {"c_1", 0.5},
                                                                  {"B_oil", 1.5e9},
                                                                  {"B_c", 3.15e10}}});
    start.push_back({head + ".p", pressure});
  }
  Scene scene = scene_of("Manifold of " + std::to_string(cylinders) + " cylinders", names({"mechanics", "hydraulics"}),
                         std::move(components));
  scene.root.set("start", std::move(start));
  return scene;
}

double drawbar(int trailer, int count) { return 2.0 + 2.0 * (trailer - 1) / count; }

Scene trailers(int count) {
  constexpr double mass = 1000.0, inertia = 800.0;
  const auto body = [&](double x) {
    return Value::Object{{"type", "mechanics/planar_body"},
                         {"mass", mass},
                         {"inertia", inertia},
                         {"position", list({x, 0})},
                         {"velocity", list({trailer_speed, 0})}};
  };
  const auto axle = [](const std::string& of) { return Value::Object{{"type", "mechanics/knife_edge"}, {"body", of}}; };
  double x = 0.0;
  Value::Object components = {{"tractor", body(x)}, {"axle", axle("tractor")}};
  for (int i = 1; i <= count; ++i) {
    const double length = drawbar(i, count);
    x -= length;
    const std::string trailer = numbered("trailer_", i);
    components.push_back({trailer, body(x)});
    components.push_back({numbered("axle_", i), axle(trailer)});
    components.push_back(
        {numbered("hitch_", i), planar_revolute(i == 1 ? std::string("tractor") : numbered("trailer_", i - 1),
                                                list({0, 0}), trailer, list({length, 0}))});
  }
  Scene scene =
      scene_of("Tractor with " + std::to_string(count) + " trailers", names({"mechanics"}), std::move(components));
  scene.root.set("linearize", Value::Object{{"at", "start"}});
  return scene;
}

Scene spring_lattice(int side) {
  Value::Object components;
  const auto mass = [](int i, int j) { return numbered("m_", i) + numbered("_", j); };
  int springs = 0;
  const auto connect = [&](const std::string& from, const std::string& to) {  // from "": the frame
    Value spring =
        Value::Object{{"type", "mechanics/spring_damper"}, {"to", to + ".x"}, {"stiffness", lattice_stiffness}};
    if (!from.empty()) spring.set("from", from + ".x");
    components.push_back({numbered("k_", ++springs), std::move(spring)});
  };
  for (int i = 1; i <= side; ++i) {
    for (int j = 1; j <= side; ++j) {
      components.push_back({mass(i, j), Value::Object{{"type", "mechanics/mass"}, {"mass", lattice_mass}}});
      connect(i > 1 ? mass(i - 1, j) : "", mass(i, j));
      connect(j > 1 ? mass(i, j - 1) : "", mass(i, j));
      if (i == side) connect("", mass(i, j));
      if (j == side) connect("", mass(i, j));
    }
  }
  return scene_of("Lattice of " + std::to_string(side) + " x " + std::to_string(side) + " masses", names({"mechanics"}),
                  std::move(components));
}

const std::vector<Family>& families() {
  static const std::vector<Family> all = {
      {"planar_chain", [](int size) { return planar_chain(size); }},
      {"spatial_chain", [](int size) { return spatial_chain(size); }},
      {"four_bar_ladder", four_bar_ladder, 2},
      {"spatial_ladder", spatial_ladder, 2},
      {"hydraulic_chain", [](int size) { return hydraulic_chain(size, 4); }},
      {"cylinder_manifold", cylinder_manifold},
      {"trailers", trailers},
      {"spring_lattice", spring_lattice},
  };
  return all;
}

namespace {

void write(JsonWriter& json, const Value& value) {
  if (const bool* boolean = value.boolean()) {
    json.value(*boolean);
  } else if (const double* number = value.number()) {
    json.value(*number);
  } else if (const std::string* text = value.text()) {
    json.value(std::string_view(*text));
  } else if (const Value::List* items = value.list()) {
    json.begin_list(true);
    for (const Value& item : *items) write(json, item);
    json.end_list();
  } else if (const Value::Object* members = value.object()) {
    json.begin_object();
    for (const Member& member : *members) {
      json.key(member.key);
      write(json, member.value);
    }
    json.end_object();
  } else {
    json.null();
  }
}

}  // namespace

std::string scene_text(const Scene& scene) {
  JsonWriter json;
  write(json, scene.root);
  return json.take();
}

std::shared_ptr<Registry> shared_registry() {
  static const auto registry = std::make_shared<Registry>();
  return registry;
}

Compiled compiled(const Scene& scene) { return compile(scene, shared_registry()); }

}  // namespace bramah::support
