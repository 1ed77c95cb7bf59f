#include "coordinator/results/results.hpp"

#include <fmt/format.h>

#include <exception>
#include <future>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "common/error.hpp"
#include "common/scene/columns.hpp"
#include "common/scene/element_columns.hpp"
#include "common/scene/sensor_columns.hpp"
#include "coordinator/results/body_meshes.hpp"
#include "coordinator/results/disk_error.hpp"
#include "coordinator/results/rows.hpp"
#include "coordinator/results/series/body_series.hpp"
#include "coordinator/results/series/contact_series.hpp"
#include "coordinator/results/series/particle_series.hpp"
#include "coordinator/results/wall_fields.hpp"

namespace tandem::launch {
namespace {

// Copies into the memory of the previous copy, where there is one.
template <class T>
void copy_to(std::optional<T>& copy, const T* from) {
  if (from != nullptr)
    copy = *from;
  else
    copy.reset();
}

std::vector<std::string> with_time(const std::vector<std::string>& columns) {
  std::vector<std::string> all = {"time"};
  all.insert(all.end(), columns.begin(), columns.end());
  return all;
}

constexpr const char *bodies_file = "bodies.csv", *joints_file = "joints.csv",
                     *elements_file = "elements.csv", *sensors_file = "sensors.csv";

const std::filesystem::path& prepared(const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) fail_on_disk(folder, "cannot make the folder: " + failure.message());
  return folder;
}

void expect_columns(std::size_t sent, std::size_t columns, const char* sender, const char* values,
                    const char* capability) {
  if (sent == columns) return;
  throw Error(ErrorCode::protocol,
              fmt::format("sent {} {}, and the scene has {} columns", sent, values, columns), sender,
              fmt::format("send one value for each column of the scene, or do without {}", capability));
}

}  // namespace

struct Results::State {
  State(const std::filesystem::path& folder, const scene::Scene& given,
        const std::vector<protocol::NamedMesh>& meshes, const std::vector<BodyMesh>& shapes)
      : scene(given),
        bodies(prepared(folder) / bodies_file, with_time(scene::body_columns(given))),
        joints(folder / joints_file, with_time(scene::joint_columns(given))) {
    const bool particles = scene.dem && scene.output.particles;
    std::vector<BodyMesh> drawn = body_meshes(scene, meshes, shapes);
    const bool liquid = scene.sph && scene.output.particles;
    if (particles || liquid || !drawn.empty()) prepared(folder / frames_folder);
    if (particles) particle_series.emplace(folder, "particles");
    if (liquid) liquid_series.emplace(folder, "liquid");
    if (!scene.output.contacts.empty()) contact_series.emplace(folder);
    if (!scene.output.wall_fields.empty()) wall_fields.emplace(scene, meshes, drawn);
    if (!drawn.empty()) body_series.emplace(folder, std::move(drawn));
    if (const auto columns = scene::sensor_columns(scene); !columns.empty())
      sensors.emplace(folder / sensors_file, with_time(columns));
  }

  void require(bool present, const char* what) const {
    if (!present) throw Error(ErrorCode::internal, std::string("no ") + what + " to record", "results");
  }

  // Waits for the frame that is being written.
  void wait() {
    if (writing.valid()) writing.get();
  }

  scene::Scene scene;
  Signals bodies, joints;
  std::optional<Signals> elements, sensors;
  std::size_t element_columns = 0;
  std::optional<ParticleSeries> particle_series, liquid_series;
  std::optional<BodySeries> body_series;
  std::optional<WallFields> wall_fields;
  std::optional<ContactSeries> contact_series;

  // The columns that the scene asks for.
  std::vector<ParticleSeries::Column> columns_of(const protocol::ParticlesFrame& frame) const {
    using scene::SphereField;
    std::vector<ParticleSeries::Column> columns;
    const auto column = [&](SphereField field, auto values) {
      columns.push_back({std::string(scene::sphere_field_names[static_cast<std::size_t>(field)]), values});
    };
    const auto by_group = [&](auto value_of) {
      std::vector<std::uint32_t> values;
      values.reserve(frame.id.size());
      for (const std::uint32_t id : frame.id) values.push_back(value_of(group_of_sphere.at(id)));
      return values;
    };
    const auto of_contacts = [&](std::size_t which) {
      constexpr std::size_t stride = protocol::ParticlesFrame::contact_values;
      if (frame.contacts.size() != stride * frame.id.size())
        throw Error(ErrorCode::protocol, "a frame lacks the contacts of the spheres", "dem_server",
                    "send them, or do without can_observe_contacts");
      std::vector<float> values(frame.id.size());
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = frame.contacts[stride * i + which];
      return values;
    };
    for (const SphereField field : scene.output.fields) switch (field) {
        case SphereField::group:
          column(field, by_group([](std::uint32_t group) { return group; }));
          break;
        case SphereField::material:
          column(field,
                 by_group([&](std::uint32_t group) { return scene.dem->particles[group].material.value; }));
          break;
        case SphereField::contact_count: {
          const std::vector<float> counts = of_contacts(0);
          column(field, std::vector<std::uint32_t>(counts.begin(), counts.end()));
          break;
        }
        case SphereField::mean_stress:
          column(field, of_contacts(1));
      }
    return columns;
  }

  // Pressure and density, which the particles of a liquid have besides what spheres have.
  static std::vector<ParticleSeries::Column> columns_of_liquid(const protocol::ParticlesFrame& frame) {
    constexpr std::size_t stride = protocol::ParticlesFrame::liquid_values;
    if (frame.liquid.size() != stride * frame.id.size())
      throw Error(ErrorCode::protocol, "a frame lacks pressure and density of the liquid", "sph_server",
                  "send two numbers for each particle");
    std::vector<float> pressure(frame.id.size()), density(frame.id.size());
    for (std::size_t i = 0; i < frame.id.size(); ++i) {
      pressure[i] = frame.liquid[stride * i];
      density[i] = frame.liquid[stride * i + 1];
    }
    return {{"pressure", std::move(pressure)}, {"density", std::move(density)}};
  }

  std::vector<std::uint32_t> group_of_sphere;  // by id

  // The frame that is being written: one at a time, in order.
  std::optional<protocol::BodiesFrame> frame_bodies;
  std::optional<protocol::ParticlesFrame> frame_particles, frame_liquid;
  std::future<void> writing;  // last: its destructor waits for the task, which uses the members above
};

Results::Results(const std::filesystem::path& folder, const scene::Scene& scene,
                 const std::vector<protocol::NamedMesh>& meshes, const std::vector<BodyMesh>& shapes)
    : state_(std::make_unique<State>(folder, scene, meshes, shapes)) {}

Results::~Results() = default;

void Results::add_elements() {
  const std::vector<std::string> columns = scene::element_columns(state_->scene);
  if (columns.empty()) return;
  state_->element_columns = columns.size();
  state_->elements.emplace(state_->bodies.file().parent_path() / elements_file, with_time(columns));
}

std::vector<const Signals*> Results::signals() const {
  std::vector<const Signals*> all{&state_->bodies, &state_->joints};
  if (state_->elements) all.push_back(&*state_->elements);
  if (state_->sensors) all.push_back(&*state_->sensors);
  return all;
}

void Results::begin_with(const std::filesystem::path& earlier, const std::vector<RowMark>& marks) {
  std::size_t next = 0;
  const auto begin = [&](Signals& signals) {
    signals.begin_with(earlier / signals.file().filename(), marks.at(next++));
  };
  begin(state_->bodies);
  begin(state_->joints);
  if (state_->elements) begin(*state_->elements);
  if (state_->sensors) begin(*state_->sensors);
}

void Results::flush_rows() {
  for (const Signals* signals : signals()) signals->flush_to_disk();
}

void Results::record(Nanoseconds time, const protocol::BodiesFrame* bodies, const protocol::LoadSet* loads) {
  // An error of writing a frame is reported at the next window, not only at the next frame.
  if (state_->writing.valid() &&
      state_->writing.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
    state_->wait();
  const scene::Scene& scene = state_->scene;
  state_->require(!scene.has_particles() || loads != nullptr, "contact loads");
  state_->require(!scene.mbd || (bodies != nullptr && bodies->bodies.size() == scene.mbd->bodies.size() &&
                                 bodies->joints.size() == scene.mbd->joints.size()),
                  "complete set of bodies and joints");
  std::vector<double> row = {to_seconds(time)};
  add_body_values(scene, bodies, loads, row);
  state_->bodies.append(row);
  const auto append = [&](Signals& signals, const std::vector<double>& values) {
    row.resize(1);
    row.insert(row.end(), values.begin(), values.end());
    signals.append(row);
  };
  if (state_->sensors) {
    const char* sender = !scene.sph ? "dem_server" : !scene.dem ? "sph_server" : "dem_server, sph_server";
    expect_columns(loads->sensors.size(), state_->sensors->names().size() - 1, sender, "values of sensors",
                   "can_measure");
    append(*state_->sensors, loads->sensors);
  }
  if (!scene.mbd) return;
  row.resize(1);
  add_joint_values(*bodies, row);
  state_->joints.append(row);
  if (!state_->elements) return;
  expect_columns(bodies->elements.size(), state_->element_columns, "mbd_server", "values of elements",
                 "can_observe_elements");
  append(*state_->elements, bodies->elements);
}

void Results::set_groups(std::vector<std::uint32_t> group_of_sphere) {
  state_->group_of_sphere = std::move(group_of_sphere);
}

protocol::ParticlesFrame& Results::particles_to_write() {
  state_->wait();
  if (!state_->frame_particles) state_->frame_particles.emplace();
  return *state_->frame_particles;
}

protocol::ParticlesFrame& Results::liquid_to_write() {
  state_->wait();
  if (!state_->frame_liquid) state_->frame_liquid.emplace();
  return *state_->frame_liquid;
}

void Results::write_frame(Nanoseconds time, const protocol::BodiesFrame* bodies,
                          const protocol::ParticlesFrame* particles, PrepareParticles prepare) {
  State& s = *state_;
  s.wait();
  s.require(!s.particle_series || particles != nullptr, "particles");
  s.require(!s.liquid_series || (s.frame_liquid && s.frame_liquid->time == time), "liquid");
  copy_to(s.frame_bodies, bodies);
  if (!s.frame_particles || particles != &*s.frame_particles) copy_to(s.frame_particles, particles);
  auto write = [&s, time, prepare = std::move(prepare)] {
    if (prepare && s.frame_particles) prepare(*s.frame_particles);
    try {
      if (s.particle_series) s.particle_series->append(*s.frame_particles, s.columns_of(*s.frame_particles));
      if (s.liquid_series)
        s.liquid_series->append(*s.frame_liquid, State::columns_of_liquid(*s.frame_liquid));
      if (s.contact_series) s.contact_series->append(*s.frame_particles);
      std::vector<std::vector<CellColumn>> cells;
      if (s.wall_fields) cells = s.wall_fields->of(*s.frame_particles);
      if (s.body_series) s.body_series->append(time, s.frame_bodies ? &*s.frame_bodies : nullptr, cells);
    } catch (const Error& error) {
      throw Error(error.code(), fmt::format("{} (frame of t = {:.6g} s)", error.problem(), to_seconds(time)),
                  error.where(), error.hint());
    }
  };
  try {
    s.writing = std::async(std::launch::async, std::move(write));
  } catch (const std::system_error& failure) {
    throw Error(ErrorCode::resource,
                std::string("no thread can be started to write frames: ") + failure.what(), "results");
  }
}

void Results::finish() {
  // Also after a failure of the last frame: the index files list the frames before it.
  std::exception_ptr failure;
  try {
    state_->wait();
  } catch (...) {
    failure = std::current_exception();
  }
  if (state_->particle_series) state_->particle_series->finish();
  if (state_->liquid_series) state_->liquid_series->finish();
  if (state_->body_series) state_->body_series->finish();
  if (state_->contact_series) state_->contact_series->finish();
  if (failure) std::rethrow_exception(failure);
}

const Signals& Results::bodies() const {
  return state_->bodies;
}
const Signals& Results::joints() const {
  return state_->joints;
}
const Signals* Results::elements() const {
  return state_->elements ? &*state_->elements : nullptr;
}
const Signals* Results::sensors() const {
  return state_->sensors ? &*state_->sensors : nullptr;
}

}  // namespace tandem::launch
