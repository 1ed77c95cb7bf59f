#include "launch/results/results.hpp"

#include <optional>
#include <string>

#include "common/error.hpp"
#include "common/scene/columns.hpp"
#include "launch/results/body_meshes.hpp"
#include "launch/results/disk_error.hpp"
#include "launch/results/series/body_series.hpp"
#include "launch/results/series/particle_series.hpp"

namespace tandem::launch {
namespace {

void add_vector(std::vector<double>& row, Vec3d v) {
  row.insert(row.end(), {v.x, v.y, v.z});
}

std::vector<std::string> with_time(const std::vector<std::string>& columns) {
  std::vector<std::string> all = {"time"};
  all.insert(all.end(), columns.begin(), columns.end());
  return all;
}

// Makes the folder and takes away the series of an earlier run, which a run that dies early would else leave
// to deceive.
const std::filesystem::path& prepared(const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) fail_on_disk(folder, "cannot make the folder: " + failure.message());
  for (const char* old : {"particles.h5", "particles.xdmf", "bodies.h5", "bodies.xdmf"}) {
    std::filesystem::remove(folder / old, failure);
    if (failure) fail_on_disk(folder / old, "cannot remove the file of an earlier run: " + failure.message());
  }
  return folder;
}

}  // namespace

struct Results::State {
  State(const std::filesystem::path& folder, const scene::Scene& given,
        const std::vector<protocol::NamedMesh>& meshes)
      : scene(given),
        bodies(prepared(folder) / "bodies.csv", with_time(scene::body_columns(given))),
        joints(folder / "joints.csv", with_time(scene::joint_columns(given))) {
    if (scene.dem) particle_series.emplace(folder);
    if (std::vector<BodyMesh> drawn = body_meshes(scene, meshes); !drawn.empty()) {
      body_series.emplace(folder, std::move(drawn));
    }
  }

  void require(bool present, const char* what) const {
    if (!present) throw Error(ErrorCode::internal, std::string("no ") + what + " to record", "results");
  }

  // Values in the order of scene::body_columns() and scene::joint_columns().
  std::vector<double> body_row(double time, const protocol::BodiesFrame* frame,
                               const protocol::LoadSet* loads) const;
  std::vector<double> joint_row(double time, const protocol::BodiesFrame& frame) const;

  scene::Scene scene;
  Signals bodies, joints;
  std::optional<ParticleSeries> particle_series;
  std::optional<BodySeries> body_series;
};

std::vector<double> Results::State::body_row(double time, const protocol::BodiesFrame* frame,
                                             const protocol::LoadSet* loads) const {
  const std::size_t count = scene.mbd ? scene.mbd->bodies.size() : 0;
  // Bodies without walls bear no contact load and are not in the load set.
  std::vector<Wrench> load(count + 1);
  if (loads != nullptr) {
    for (const protocol::BodyLoad& body : loads->bodies) {
      load.at(BodyId{body.body} == ground ? count : body.body) = body.mean;
    }
  }
  std::vector<double> row = {time};
  for (std::size_t i = 0; i < count; ++i) {
    const protocol::BodyState& body = frame->bodies[i];
    const Quat& q = body.pose.q_WB;
    add_vector(row, body.pose.p_WB);
    row.insert(row.end(), {q.w, q.x, q.y, q.z});
    add_vector(row, body.twist.v_WB);
    add_vector(row, body.twist.w_WB);
    if (!scene.dem) continue;
    add_vector(row, load[i].force);
    add_vector(row, load[i].torque);
  }
  if (scene.dem) {
    add_vector(row, load[count].force);
    add_vector(row, load[count].torque);
  }
  return row;
}

std::vector<double> Results::State::joint_row(double time, const protocol::BodiesFrame& frame) const {
  std::vector<double> row = {time};
  for (const protocol::JointState& joint : frame.joints) {
    row.push_back(joint.q);
    row.push_back(joint.rate);
    add_vector(row, joint.reaction.force);
    add_vector(row, joint.reaction.torque);
  }
  return row;
}

Results::Results(const std::filesystem::path& folder, const scene::Scene& scene,
                 const std::vector<protocol::NamedMesh>& meshes)
    : state_(std::make_unique<State>(folder, scene, meshes)) {}

Results::~Results() = default;

void Results::record(Nanoseconds time, const protocol::BodiesFrame* bodies, const protocol::LoadSet* loads) {
  const scene::Scene& scene = state_->scene;
  state_->require(!scene.dem || loads != nullptr, "contact loads");
  state_->require(!scene.mbd || (bodies != nullptr && bodies->bodies.size() == scene.mbd->bodies.size() &&
                                 bodies->joints.size() == scene.mbd->joints.size()),
                  "complete set of bodies and joints");
  state_->bodies.append(state_->body_row(to_seconds(time), bodies, loads));
  if (scene.mbd) state_->joints.append(state_->joint_row(to_seconds(time), *bodies));
}

void Results::write_frame(Nanoseconds time, const protocol::BodiesFrame* bodies,
                          const protocol::ParticlesFrame* particles) {
  if (state_->particle_series) {
    state_->require(particles != nullptr, "particles");
    state_->particle_series->append(*particles);
  }
  if (state_->body_series) state_->body_series->append(time, bodies);
}

const Signals& Results::bodies() const {
  return state_->bodies;
}
const Signals& Results::joints() const {
  return state_->joints;
}

}  // namespace tandem::launch
