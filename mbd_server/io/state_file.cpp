#include "mbd_server/io/state_file.hpp"

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/state_file.hpp"
#include "mbd_server/state/fields.hpp"

namespace tandem::mbd {
namespace {

constexpr const char* kind = "tandem multibody state";
constexpr std::uint64_t version = 4;

// What makes a state one of this machine's: its coordinates and the equations of its loops.
std::string machine(const Model& model) {
  std::string text;
  for (const std::string& name : model.coordinate_names) text += name + "\n";
  for (const Closure& closure : model.closures)
    for (const Equation& equation : closure.equations) text += closure.name + ": " + equation.what + "\n";
  return text + fmt::format("{} boundary bodies, {} inputs\n", model.boundary.size(), model.inputs);
}

// The first line in which the texts differ.
std::pair<std::string, std::string> difference(const std::string& a, const std::string& b) {
  std::size_t i = 0, line = 0;
  for (; i < a.size() && i < b.size() && a[i] == b[i]; ++i)
    if (a[i] == '\n') line = i + 1;
  return {a.substr(line, a.find('\n', line) - line), b.substr(line, b.find('\n', line) - line)};
}

}  // namespace

void write_state(const std::filesystem::path& path, const Model& model, const State& state,
                 const RunTotals& totals) {
  StateWriter file(path, kind, version);
  file.write("machine", machine(model));
  for_each_total(totals,
                 [&](const std::string& name, double value) { file.write("totals/" + name, value); });
  for_each_field(state, [&]<class Field>(const char* name, const Field& field) {
    if constexpr (std::is_arithmetic_v<Field>)
      file.write(name, field);
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
                "is the state of another machine: it has '" + theirs + "' where the scene has '" + here + "'",
                path.string(), "give the scene that the state was saved from");
  }
  SavedState saved;
  State& state = saved.state;
  for_each_total(saved.totals,
                 [&](const std::string& name, double& value) { file.read("totals/" + name, value); });
  state.q.setZero(model.coordinates);
  state.u.setZero(model.freedoms);
  state.udot = state.a = state.udot_rate = state.u;
  state.lambda.setZero(model.equations);
  state.inputs.setZero(model.inputs);
  state.loads.setZero(6, std::ssize(model.boundary));
  state.load_rates = state.loads;
  if (file.size("stops") > 0) state.stops.setZero(StopRow::count, std::ssize(model.stops));
  if (file.size("coarse") > 0) state.coarse = state.fine = VectorXd::Zero(packed_size(state));
  for_each_field(state, [&]<class Field>(const char* name, Field& field) {
    if constexpr (std::is_arithmetic_v<Field>)
      file.read(name, field);
    else
      file.read(name, std::span(field.data(), static_cast<std::size_t>(field.size())));
  });
  return saved;
}

}  // namespace tandem::mbd
