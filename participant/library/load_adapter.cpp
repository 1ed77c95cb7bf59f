#include <bit>

#include "participant/library/adapter.hpp"
#include "participant/library/adapter_base.hpp"
#include "participant/library/features.hpp"
#include "participant/library/layout.hpp"

namespace tandem::participant {
namespace {

class LoadAdapter final : public AdapterBase<protocol::LoadSolver, tandem_load_solver> {
 public:
  LoadAdapter(const tandem_load_solver& table, void* self, std::string program, protocol::Role role)
      : AdapterBase(table, self, std::move(program), role) {
    expect_common(table_, TANDEM_CAN_ROLLBACK | TANDEM_CAN_INTERPOLATE | TANDEM_CAN_WINDOW_MEAN |
                              TANDEM_CAN_LINEARISE | TANDEM_CAN_RESPOND | TANDEM_CAN_CHECKPOINT |
                              (of_liquid() ? TANDEM_CAN_OBSERVE_LIQUID : 0));
    expect_function(!(table_.capabilities & TANDEM_CAN_LINEARISE) || table_.linearise, "linearise",
                    "TANDEM_CAN_LINEARISE promises");
    expect_function(!responds() || (table_.capabilities & TANDEM_CAN_LINEARISE), "TANDEM_CAN_LINEARISE",
                    "TANDEM_CAN_RESPOND needs");
  }

  protocol::Role role() const override { return role_; }

  protocol::Configured configure(const protocol::Configuration& configuration) override {
    view_ = std::make_unique<SceneView>(configuration, role_);
    const scene::Scene& scene = view_->scene();
    if (of_liquid() ? !scene.sph : !scene.dem)
      throw Error(ErrorCode::scene, std::string("has no '") + protocol::word_of(role_) + "'",
                  configuration.origin, "no such solver is needed");
    expect_known(of_liquid() ? features_of_sph(scene) : features_of_dem(scene, view_->spinning_group()),
                 names_of(table_.features), program_);
    tandem_facts facts(role_);
    expect_ok(table_.configure(self_, &view_->configuration(), &facts), "configure");
    for (const std::uint32_t body : view_->boundary()) {
      blank_.push_back(of_body<protocol::BodyLoad>(body));
      blank_tangents_.push_back(of_body<protocol::BodyTangent>(body));
    }
    if (view_->ground_has_walls()) blank_.push_back(of_body<protocol::BodyLoad>(TANDEM_GROUND));
    if (!of_liquid()) facts.values["spheres"] = view_->configuration().sphere_count;
    return {{}, facts.text()};
  }

  const protocol::LoadSet& advance(const protocol::MotionSet& motion) override {
    loads_.window = motion.window;
    loads_.account = {};
    loads_.bodies = blank_;
    tandem_motion_set ordered{
        view(motion.window), motion.bodies.size(),
        reinterpret_cast<tandem_body_motion*>(const_cast<protocol::BodyMotion*>(motion.bodies.data()))};
    tandem_load_set set{view(motion.window),
                        {},
                        loads_.bodies.size(),
                        reinterpret_cast<tandem_body_load*>(loads_.bodies.data())};
    expect_ok(table_.advance(self_, &ordered, &set), "advance");
    loads_.account = std::bit_cast<protocol::ParticleAccount>(set.account);
    now_ = motion.window.end;
    return loads_;
  }

  const protocol::TangentSet& linearise() override {
    tangents_.time = now_;
    tangents_.bodies = blank_tangents_;
    tandem_tangent_set set{now_.count, tangents_.bodies.size(),
                           reinterpret_cast<tandem_body_tangent*>(tangents_.bodies.data()), 0, nullptr};
    expect_ok(table_.linearise(self_, &set), "linearise");
    if (!responds() && set.responses)
      throw Error(ErrorCode::internal, "is given: `capabilities` has no TANDEM_CAN_RESPOND",
                  "linearise: responses", "leave it out");
    const auto* responses = reinterpret_cast<const protocol::BodyResponse*>(set.responses);
    tangents_.responses.assign(responses, responses + (responses ? set.response_count : 0));
    return tangents_;
  }

  const protocol::ParticlesFrame& observe() override {
    tandem_particles_frame frame{};
    frame.time = now_.count;
    expect_ok(table_.observe(self_, &frame), "observe");
    expect_count(frame.count);
    frame_.time = now_;
    assign(frame_.id, frame.id, frame.count, "id");
    assign(frame_.position, frame.position, 3 * frame.count, "position");
    assign(frame_.velocity, frame.velocity, 3 * frame.count, "velocity");
    if (of_liquid()) {
      observe_liquid(frame);
    } else {
      expect_absent(frame.pressure || frame.density, "pressure or density", "spheres have none");
      assign(frame_.spin, frame.spin, 3 * frame.count, "spin");
      assign(frame_.radius, frame.radius, frame.count, "radius");
    }
    return frame_;
  }

 private:
  bool of_liquid() const { return role_ == protocol::Role::sph; }
  bool responds() const { return table_.capabilities & TANDEM_CAN_RESPOND; }

  static void expect_absent(bool given, const char* arrays, const char* why) {
    if (given)
      throw Error(ErrorCode::internal, std::string("is given: ") + why, std::string("observe: ") + arrays,
                  "leave it out");
  }

  // Particles of a liquid have no spin, and half a spacing as radius.
  void observe_liquid(const tandem_particles_frame& frame) {
    expect_absent(frame.spin || frame.radius, "spin or radius", "particles of a liquid have none");
    frame_.spin.assign(3 * frame.count, 0);
    frame_.radius.assign(frame.count, static_cast<float>(0.5 * view_->configuration().spacing));
    const bool stated = table_.capabilities & TANDEM_CAN_OBSERVE_LIQUID;
    expect_absent(!stated && (frame.pressure || frame.density), "pressure or density",
                  "`capabilities` has no TANDEM_CAN_OBSERVE_LIQUID");
    if (!stated) return;
    std::vector<float> pressure, density;
    assign(pressure, frame.pressure, frame.count, "pressure");
    assign(density, frame.density, frame.count, "density");
    frame_.liquid.clear();
    for (std::size_t i = 0; i < frame.count; ++i) {
      frame_.liquid.push_back(pressure[i]);
      frame_.liquid.push_back(density[i]);
    }
  }

  std::vector<protocol::BodyLoad> blank_;
  std::vector<protocol::BodyTangent> blank_tangents_;
  protocol::LoadSet loads_;
  protocol::TangentSet tangents_;
  protocol::ParticlesFrame frame_;
};

}  // namespace

std::unique_ptr<protocol::LoadSolver> make_load_solver(const tandem_load_solver& table, void* self,
                                                       std::string program, protocol::Role role) {
  return std::make_unique<LoadAdapter>(table, self, std::move(program), role);
}

}  // namespace tandem::participant
