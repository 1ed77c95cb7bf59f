#include <bit>

#include "participant/library/adapter.hpp"
#include "participant/library/adapter_base.hpp"
#include "participant/library/features.hpp"
#include "participant/library/layout.hpp"

namespace tandem::participant {
namespace {

class LoadAdapter final : public AdapterBase<protocol::LoadSolver, tandem_load_solver> {
 public:
  LoadAdapter(const tandem_load_solver& table, void* self, std::string program)
      : AdapterBase(table, self, std::move(program), "dem_") {
    expect_common(table_, TANDEM_CAN_ROLLBACK | TANDEM_CAN_INTERPOLATE | TANDEM_CAN_WINDOW_MEAN |
                              TANDEM_CAN_LINEARISE | TANDEM_CAN_CHECKPOINT);
    expect_function(!(table_.capabilities & TANDEM_CAN_LINEARISE) || table_.linearise, "linearise",
                    "TANDEM_CAN_LINEARISE promises");
  }

  protocol::Configured configure(const protocol::Configuration& configuration) override {
    view_ = std::make_unique<SceneView>(configuration, protocol::Role::dem);
    if (!view_->scene().dem)
      throw Error(ErrorCode::scene, "has no 'dem'", configuration.origin, "no load solver is needed");
    expect_known(features_of_dem(view_->scene(), view_->spinning_group()), names_of(table_.features),
                 program_);
    tandem_facts facts(prefix_);
    expect_ok(table_.configure(self_, &view_->configuration(), &facts), "configure");
    for (const std::uint32_t body : view_->boundary()) {
      blank_.push_back(of_body<protocol::BodyLoad>(body));
      blank_tangents_.push_back(of_body<protocol::BodyTangent>(body));
    }
    if (view_->ground_has_walls()) blank_.push_back(of_body<protocol::BodyLoad>(TANDEM_GROUND));
    facts.values["spheres"] = view_->configuration().sphere_count;
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
                           reinterpret_cast<tandem_body_tangent*>(tangents_.bodies.data())};
    expect_ok(table_.linearise(self_, &set), "linearise");
    return tangents_;
  }

  const protocol::ParticlesFrame& observe() override {
    tandem_particles_frame frame{now_.count, 0, nullptr, nullptr, nullptr, nullptr, nullptr};
    expect_ok(table_.observe(self_, &frame), "observe");
    expect_count(frame.count);
    frame_.time = now_;
    assign(frame_.id, frame.id, frame.count, "id");
    assign(frame_.position, frame.position, 3 * frame.count, "position");
    assign(frame_.velocity, frame.velocity, 3 * frame.count, "velocity");
    assign(frame_.spin, frame.spin, 3 * frame.count, "spin");
    assign(frame_.radius, frame.radius, frame.count, "radius");
    return frame_;
  }

 private:
  std::vector<protocol::BodyLoad> blank_;
  std::vector<protocol::BodyTangent> blank_tangents_;
  protocol::LoadSet loads_;
  protocol::TangentSet tangents_;
  protocol::ParticlesFrame frame_;
};

}  // namespace

std::unique_ptr<protocol::LoadSolver> make_load_solver(const tandem_load_solver& table, void* self,
                                                       std::string program) {
  return std::make_unique<LoadAdapter>(table, self, std::move(program));
}

}  // namespace tandem::participant
