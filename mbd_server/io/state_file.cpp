#include "mbd_server/io/state_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <type_traits>
#include <vector>

#include "common/error.hpp"
#include "common/state_file.hpp"
#include "common/utf8.hpp"
#include "mbd_server/forces/element_force.hpp"
#include "mbd_server/io/tyre_bottoming.hpp"
#include "mbd_server/state/fields.hpp"

namespace tandem::mbd {
namespace {

constexpr const char* kind = "tandem multibody state";
constexpr std::uint64_t version = 14;

// Text that identifies the machine of a state: its coordinates and the equations of its loops.
std::string machine(const Model& model) {
  std::string text;
  for (const std::string& name : model.coordinate_names) text += name + "\n";
  for (const Closure& closure : model.closures)
    for (const Equation& equation : closure.equations) text += closure.name + ": " + equation.what + "\n";
  for (const std::string& name : model.state_names) text += name + "\n";
  return text +
         fmt::format("{} boundary bodies, {} inputs, {} elements\n", model.boundary.size(), model.inputs,
                     model.accounts) +
         (model.contact.empty() ? std::string()
                                : fmt::format("{} shapes of contact\n", model.contact.shapes.size())) +
         (model.contact.time_stepping ? "time stepping of contacts\n" : "");
}

// The first line in which the texts differ.
std::pair<std::string, std::string> difference(const std::string& a, const std::string& b) {
  std::size_t i = 0, line = 0;
  for (; i < a.size() && i < b.size() && a[i] == b[i]; ++i)
    if (a[i] == '\n') line = i + 1;
  return {a.substr(line, a.find('\n', line) - line), b.substr(line, b.find('\n', line) - line)};
}

// Fields of the points of contact: one array for each, by name.
struct PointArrays {
  std::map<std::string, std::vector<double>> real;
  std::map<std::string, std::vector<std::uint64_t>> whole;

  template <class Field>
  auto& of(const char* field) {
    if constexpr (std::is_same_v<Field, double> || std::is_same_v<Field, Vector3d>)
      return real[field];
    else
      return whole[field];
  }
};

void write_points(StateWriter& file, const std::string& name, const std::vector<ContactPoint>& points) {
  PointArrays arrays;
  const ContactPoint any;
  for_each_point_field(any, [&]<class Field>(const char* field, const Field&) { arrays.of<Field>(field); });
  for (const ContactPoint& point : points)
    for_each_point_field(point, [&]<class Field>(const char* field, const Field& value) {
      auto& array = arrays.of<Field>(field);
      if constexpr (std::is_same_v<Field, Vector3d>)
        array.insert(array.end(), value.begin(), value.end());
      else if constexpr (std::is_same_v<Field, double>)
        array.push_back(value);
      else
        array.push_back(static_cast<std::uint64_t>(static_cast<std::int64_t>(value)));
    });
  for (const auto& [field, values] : arrays.real) file.write(name + "/" + field, std::span(values));
  for (const auto& [field, values] : arrays.whole) file.write(name + "/" + field, std::span(values));
}

void read_points(const StateReader& file, const std::string& name, std::vector<ContactPoint>& points) {
  points.assign(file.size(name + "/mass"), {});
  PointArrays arrays;
  const ContactPoint any;
  for_each_point_field(any, [&]<class Field>(const char* field, const Field&) {
    auto& array = arrays.of<Field>(field);
    array.resize(points.size() * (std::is_same_v<Field, Vector3d> ? 3 : 1));
    file.read(name + "/" + field, std::span(array));
  });
  for (std::size_t k = 0; k < points.size(); ++k)
    for_each_point_field(points[k], [&]<class Field>(const char* field, Field& value) {
      const auto& array = arrays.of<Field>(field);
      if constexpr (std::is_same_v<Field, Vector3d>)
        value = Eigen::Map<const Vector3d>(&array[3 * k]);
      else if constexpr (std::is_same_v<Field, double>)
        value = array[k];
      else
        value = static_cast<Field>(static_cast<std::int64_t>(array[k]));
    });
}

// Throws, by `fail`, where a point has a field that no step leaves.
template <class Fail>
void expect_sound_point(const ContactPoint& point, const Model& model, const Fail& fail) {
  for_each_point_field(point, [&]<class Field>(const char* field, const Field& value) {
    const std::string name = std::string("contacts/") + field;
    if constexpr (std::is_same_v<Field, double>) {
      if (!std::isfinite(value)) fail(name, value, "not finite");
    } else if constexpr (std::is_same_v<Field, Vector3d>) {
      for (const double x : value)
        if (!std::isfinite(x)) fail(name, x, "not finite");
    }
  });
  const auto expect = [&](const char* name, int value, std::ptrdiff_t count, const char* problem) {
    if (value < 0 || value >= count) fail(name, value, problem);
  };
  const std::ptrdiff_t shapes = std::ssize(model.contact.shapes);
  expect("contacts/shape_a", point.feature.a, shapes, "no number of a shape of the scene");
  expect("contacts/shape_b", point.feature.b, shapes, "no number of a shape of the scene");
  expect("contacts/kind", static_cast<int>(point.feature.kind), static_cast<int>(ContactFeature::Kind::watch),
         "no kind of a feature that touches");
}

// Throws Error{resource} where no step can have left such a value.
void expect_sound(const SavedState& saved, const Model& model, const std::filesystem::path& path) {
  const auto fail = [&](const std::string& name, double value, const char* problem) {
    throw Error(ErrorCode::resource,
                fmt::format("its value '{}' is damaged: {:g} is {}", name, value, problem), path.string(),
                "continue from another checkpoint");
  };
  for_each_field(saved.state, [&]<class Field>(const char* name, const Field& field) {
    if constexpr (std::is_same_v<Field, double>) {
      if (!(std::isfinite(field) && field >= 0)) fail(name, field, "no finite number of at least 0");
    } else if constexpr (std::is_same_v<Field, std::vector<ContactPoint>>) {
      for (const ContactPoint& point : field) expect_sound_point(point, model, fail);
    } else if constexpr (!std::is_arithmetic_v<Field>) {
      for (Eigen::Index i = 0; i < field.size(); ++i)
        if (!std::isfinite(field.data()[i])) fail(name, field.data()[i], "not finite");
    }
  });
  for (const double sliding : saved.state.sliding)
    if (sliding != 0 && sliding != 1 && sliding != -1) fail("sliding", sliding, "not -1, 0 or 1");
  for_each_total(saved.totals, [&](const std::string& name, double value) {
    if (!std::isfinite(value)) fail("totals/" + name, value, "not finite");
  });
  for_each_list(saved.totals, [&](const std::string& name, const std::vector<double>& values) {
    for (const double value : values)
      if (!std::isfinite(value)) fail("totals/" + name, value, "not finite");
  });
  const auto expect_index = [&](const char* name, double index, std::size_t count) {
    if (!(index >= -1 && index < static_cast<double>(count) && index == std::floor(index)))
      fail(name, index, "no number of a joint, loop or shape of the scene");
  };
  expect_index("totals/sharpest_turn_closure", saved.totals.sharpest_turn_closure, model.closures.size());
  expect_index("totals/largest_reaction_joint", saved.totals.largest_reaction_joint, model.joints.size());
  if (const double e = saved.totals.cavitated_element;
      !(e >= -1 && e < static_cast<double>(forces_of<Element>(model).size()) && e == std::floor(e)))
    fail("totals/cavitated_element", e, "no number of a motor or cylinder of the scene");
  expect_index("totals/contact_depth_a", saved.totals.contact_depth_a, model.contact.shapes.size());
  expect_index("totals/contact_depth_b", saved.totals.contact_depth_b, model.contact.shapes.size());
  for (const double shape : saved.totals.tyres.bottomed_shape)
    expect_index("totals/tyre_bottomed_shape", shape, model.contact.shapes.size());
  constexpr double latest = 9e9;  // [s] latest time that nanoseconds can represent
  if (saved.state.time > latest) fail("time", saved.state.time, "no time of a run");
  if (std::abs(saved.totals.fewest_freedoms) > model.freedoms + model.equations)
    fail("totals/fewest_freedoms", saved.totals.fewest_freedoms,
         "no number of degrees of freedom of the machine");
}

}  // namespace

void write_state(const std::filesystem::path& path, const Model& model, const State& state,
                 const RunTotals& totals) {
  StateWriter file(path, kind, version);
  file.write("machine", machine(model));
  for_each_total(totals, [&](const std::string& name, double value) { file.write("totals/" + name, value); });
  for_each_list(totals, [&](const std::string& name, const std::vector<double>& values) {
    file.write("totals/" + name, std::span(values));
  });
  for_each_field(state, [&]<class Field>(const char* name, const Field& field) {
    if constexpr (std::is_arithmetic_v<Field>)
      file.write(name, field);
    else if constexpr (std::is_same_v<Field, std::vector<ContactPoint>>)
      write_points(file, name, field);
    else
      file.write(name, std::span(field.data(), static_cast<std::size_t>(field.size())));
  });
  file.commit();
}

SavedState read_state(const std::filesystem::path& path, const Model& model) {
  const StateReader file(path, kind, version);
  if (const std::string of = file.text("machine"), ours = machine(model); of != ours) {
    const auto [theirs, here] = difference(of, ours);
    throw Error(ErrorCode::scene,
                "is the state of another machine: it has '" + printable(shortened(theirs)) +
                    "' where the scene has '" + shortened(here) + "'",
                path.string(), "give the scene that the state was saved from");
  }
  SavedState saved;
  State& state = saved.state;
  for_each_total(saved.totals,
                 [&](const std::string& name, double& value) { file.read("totals/" + name, value); });
  for (std::vector<double>* list :
       {&saved.totals.local_errors, &saved.totals.short_step_errors, &saved.totals.least, &saved.totals.most})
    list->assign(static_cast<std::size_t>(model.freedoms), 0);
  saved.totals.energy.work_of.assign(static_cast<std::size_t>(model.accounts), 0);
  saved.totals.energy.lost_of = saved.totals.energy.work_of;
  if (!model.contact.empty()) saved.totals.contact_impulses.assign(6 * model.boundary.size(), 0);
  saved.totals.tyres = TyreBottoming(model).totals();
  for_each_list(saved.totals, [&](const std::string& name, std::vector<double>& values) {
    // Absent where the state was written without totals.
    if (file.size("totals/" + name) > 0) file.read("totals/" + name, std::span(values));
  });
  state.q.setZero(model.coordinates);
  state.u.setZero(model.freedoms);
  state.udot = state.a = state.udot_rate = state.u;
  state.lambda.setZero(model.equations);
  state.z = state.zdot = state.w = state.zdot_rate = state.z_known =
      VectorXd::Zero(model.first_states.size());
  state.inputs.setZero(model.inputs);
  state.loads.setZero(6, std::ssize(model.boundary));
  state.load_rates = state.loads;
  if (file.size("stops") > 0) state.stops.setZero(StopRow::count, std::ssize(model.stops));
  state.sliding.setZero(std::ssize(model.stictions));
  if (!model.contact.empty()) {
    state.touch_step.setZero(1);
    state.contact_wrench.setZero(6, std::ssize(model.boundary));
    state.island_steps.setZero(3, static_cast<Eigen::Index>(file.size("island_steps") / 3));
  }
  if (file.size("coarse") > 0) state.coarse = state.fine = VectorXd::Zero(packed_size(state));
  for_each_field(state, [&]<class Field>(const char* name, Field& field) {
    if constexpr (std::is_arithmetic_v<Field>)
      file.read(name, field);
    else if constexpr (std::is_same_v<Field, std::vector<ContactPoint>>)
      read_points(file, name, field);
    else
      file.read(name, std::span(field.data(), static_cast<std::size_t>(field.size())));
  });
  expect_sound(saved, model, path);
  return saved;
}

}  // namespace tandem::mbd
