#include <bit>

#include "participant/library/adapter.hpp"
#include "participant/library/adapter_base.hpp"
#include "participant/library/features.hpp"
#include "participant/library/layout.hpp"

namespace tandem::participant {
namespace {

class MotionAdapter final : public AdapterBase<protocol::MotionSolver, tandem_motion_solver> {
 public:
  MotionAdapter(const tandem_motion_solver& table, void* self, std::string program)
      : AdapterBase(table, self, std::move(program), protocol::Role::mbd) {
    expect_common(table_, TANDEM_CAN_PREDICT | TANDEM_CAN_ROLLBACK | TANDEM_CAN_EXTRAPOLATE |
                              TANDEM_CAN_CONTROL | TANDEM_CAN_CHECKPOINT | TANDEM_CAN_OBSERVE_ELEMENTS);
    const auto expect = [&](std::uint64_t capability, bool given, const char* function) {
      expect_function(!(table_.capabilities & capability) || given, function, "its capabilities promise");
    };
    expect(TANDEM_CAN_PREDICT, table_.predict, "predict");
    expect(TANDEM_CAN_EXTRAPOLATE, table_.extrapolate, "extrapolate");
    expect(TANDEM_CAN_CONTROL, table_.control, "control");
  }

  protocol::Configured configure(const protocol::Configuration& configuration) override {
    view_ = std::make_unique<SceneView>(configuration, protocol::Role::mbd);
    if (!view_->scene().mbd)
      throw Error(ErrorCode::scene, "has no 'mbd'", configuration.origin, "no motion solver is needed");
    expect_known(features_of_mbd(view_->scene()), names_of(table_.features), program_);
    for (const std::uint32_t body : view_->boundary()) motion_.bodies.push_back(view_->start_of(body));
    tandem_motion_set initial = set_of(motion_);
    tandem_facts facts(role_);
    expect_ok(table_.configure(self_, &view_->configuration(), &initial, &facts), "configure");
    protocol::Configured configured{motion_.bodies, facts.text()};
    for (const protocol::BodyMotion& body : motion_.bodies)
      blank_.push_back(of_body<protocol::BodyMotion>(body.body));
    return configured;
  }

  const protocol::MotionSet& advance(const protocol::LoadSet& loads) override {
    const tandem_load_set ordered = set_of(loads);
    const protocol::MotionSet& motion = answer(loads.window, "advance", [&](tandem_motion_set& set) {
      return table_.advance(self_, &ordered, &set);
    });
    now_ = loads.window.end;
    return motion;
  }
  const protocol::MotionSet& predict(const Window& window) override {
    const tandem_window ordered = view(window);
    return answer(window, "predict",
                  [&](tandem_motion_set& motion) { return table_.predict(self_, &ordered, &motion); });
  }
  const protocol::MotionSet& extrapolate(const Window& window) override {
    const tandem_window ordered = view(window);
    return answer(window, "extrapolate",
                  [&](tandem_motion_set& motion) { return table_.extrapolate(self_, &ordered, &motion); });
  }

  const protocol::BodiesFrame& observe() override {
    frame_.bodies.clear();
    for (std::uint32_t b = 0; b < view_->configuration().body_count; ++b)
      frame_.bodies.push_back(of_body<protocol::BodyState>(b));
    frame_.joints.clear();
    for (std::uint32_t j = 0; j < view_->configuration().joint_count; ++j)
      frame_.joints.push_back(of_joint(j));
    if (table_.capabilities & TANDEM_CAN_OBSERVE_ELEMENTS)
      frame_.elements.assign(view_->configuration().element_count, 0);
    frame_.time = now_;
    tandem_bodies_frame frame{now_.count,
                              frame_.bodies.size(),
                              frame_.joints.size(),
                              reinterpret_cast<tandem_body_state*>(frame_.bodies.data()),
                              reinterpret_cast<tandem_joint_state*>(frame_.joints.data()),
                              0,
                              frame_.elements.size(),
                              frame_.elements.data()};
    expect_ok(table_.observe(self_, &frame), "observe");
    frame_.energy = frame.energy;
    return frame_;
  }

  void control(const protocol::ControlSet& inputs) override {
    const tandem_control_set set{inputs.time.count, inputs.values.size(), inputs.values.data()};
    expect_ok(table_.control(self_, &set), "control");
  }

 private:
  static tandem_motion_set set_of(protocol::MotionSet& set) {
    return {view(set.window), set.bodies.size(), reinterpret_cast<tandem_body_motion*>(set.bodies.data())};
  }
  static tandem_load_set set_of(const protocol::LoadSet& set) {
    return {view(set.window), std::bit_cast<tandem_particle_account>(set.account), set.bodies.size(),
            reinterpret_cast<tandem_body_load*>(const_cast<protocol::BodyLoad*>(set.bodies.data()))};
  }

  template <class Call>
  const protocol::MotionSet& answer(const Window& window, const char* function, Call call) {
    motion_.window = window;
    motion_.bodies = blank_;
    tandem_motion_set set = set_of(motion_);
    expect_ok(call(set), function);
    return motion_;
  }

  std::vector<protocol::BodyMotion> blank_;
  protocol::MotionSet motion_;
  protocol::BodiesFrame frame_;
};

}  // namespace

std::unique_ptr<protocol::MotionSolver> make_motion_solver(const tandem_motion_solver& table, void* self,
                                                           std::string program) {
  return std::make_unique<MotionAdapter>(table, self, std::move(program));
}

}  // namespace tandem::participant
