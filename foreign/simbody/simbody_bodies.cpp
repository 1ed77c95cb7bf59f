// Simbody as tandem's multibody solver, on the C interface of the participant kit: README.md says what it
// maps and what it refuses.
#include <Simbody.h>
#include <tandem/participant.h>

#include <memory>
#include <nlohmann/json.hpp>

namespace {

using Json = nlohmann::json;
using namespace SimTK;

struct Refusal {
  int code;
  std::string what, where, hint;
};

Vec3 vec(const double* v) {
  return Vec3(v[0], v[1], v[2]);
}
Vec3 vec(const Json& v) {
  return Vec3(v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
}
Transform transform(const tandem_pose& pose) {
  const double* q = pose.quaternion;
  return Transform(Rotation(Quaternion(q[0], q[1], q[2], q[3])), vec(pose.position));
}
void put(double* to, const Vec3& from) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}
// `last` is the body's quaternion before; of the two that mean the same rotation the nearer one continues it.
void put(tandem_pose& to, const Transform& from, Vec4& last) {
  put(to.position, from.p());
  const Vec4 q = from.R().convertRotationToQuaternion().asVec4();
  last = dot(q, last) < 0 ? Vec4(-q) : q;
  for (int i = 0; i < 4; ++i) to.quaternion[i] = last[i];
}
// Rotation about a vector of the frame by its length.
Rotation turn(const Vec3& w) {
  const double angle = w.norm();
  return angle > 0 ? Rotation(angle, UnitVec3(w)) : Rotation();
}

class Bodies {
 public:
  Bodies() : matter_(system_), forces_(system_), loads_(forces_, matter_) {}

  void configure(const tandem_configuration& c, tandem_motion_set& initial, tandem_facts* facts) {
    const Json scene = Json::parse(c.scene), options = Json::parse(c.solver_options);
    accuracy_ = 1e-8;
    for (const auto& [key, value] : options.items()) {
      if (key != "accuracy" || !value.is_number() || !(value.get<double>() > 0) ||
          !(value.get<double>() < 0.1))
        throw Refusal{TANDEM_ERROR_SCENE, "is " + options.dump(), "mbd.solver_options",
                      "\"accuracy\" is a number above 0 and below 0.1; there are no other options"};
      accuracy_ = value.get<double>();
    }
    mbd_ = scene.at("mbd");
    Force::Gravity(forces_, matter_, vec(c.gravity));
    for (std::size_t b = 0; b < c.body_count; ++b) {
      index_[c.bodies[b].name] = b;
      start_.push_back(transform(c.bodies[b].pose));
      const double* q = c.bodies[b].pose.quaternion;
      last_.emplace_back(q[0], q[1], q[2], q[3]);
    }
    bodies_.resize(c.body_count);
    if (mbd_.contains("joints"))
      for (const Json& joint : mbd_["joints"].get_ref<const Json::array_t&>()) {
        joints_.push_back(joint);
        if (!carried_.emplace(joint.at("child"), joint).second)
          throw Refusal{TANDEM_ERROR_SCENE, "is carried by more than one joint",
                        "mbd.bodies '" + joint.at("child").get<std::string>() + "'",
                        "this solver takes trees; use one joint per child"};
      }
    for (std::size_t b = 0; b < c.body_count; ++b) add_body(c, b, 0);
    if (mbd_.contains("forces"))
      for (const Json& force : mbd_["forces"].get_ref<const Json::array_t&>()) add_force(force);
    state_ = system_.realizeTopology();
    start_rates(c);
    system_.realize(state_, Stage::Velocity);
    write(state_, initial, false);
    write(state_, initial, true);
    integrator_ = std::make_unique<RungeKuttaMersonIntegrator>(system_);
    integrator_->setAccuracy(accuracy_);
    tandem_fact_text(facts, "simbody", "3.7");
    tandem_fact_number(facts, "accuracy", accuracy_);
  }

  void predict(tandem_motion_set& motion) {
    const double H = 1e-9 * static_cast<double>(motion.window.end - motion.window.begin);
    system_.realize(state_, Stage::Velocity);
    write(state_, motion, false);
    State ahead = state_;
    for (const MobilizedBody& body : bodies_) {
      if (MobilizedBody::Ball::isInstanceOf(body) || MobilizedBody::Free::isInstanceOf(body)) {
        const Transform X = body.getMobilizerTransform(state_);
        const SpatialVec V = body.getMobilizerVelocity(state_);
        body.setQToFitTransform(ahead, Transform(turn(H * V[0]) * X.R(), X.p() + H * V[1]));
      } else {
        for (int i = 0; i < body.getNumQ(state_); ++i)
          body.setOneQ(ahead, i, body.getOneQ(state_, i) + H * body.getOneU(state_, i));
      }
    }
    system_.realize(ahead, Stage::Velocity);
    write(ahead, motion, true);
  }

  void advance(const tandem_load_set& loads, tandem_motion_set& motion) {
    const double H = 1e-9 * static_cast<double>(motion.window.end - motion.window.begin);
    loads_.clearAllBodyForces(state_);
    std::vector<SpatialVec> load(bodies_.size(), SpatialVec(Vec3(0)));
    for (std::size_t i = 0; i < loads.count; ++i) {
      const tandem_body_load& given = loads.bodies[i];
      if (given.body == TANDEM_GROUND) continue;
      load[given.body] = SpatialVec(vec(given.mean.torque), vec(given.mean.force));
      loads_.setOneBodyForce(state_, bodies_[given.body], load[given.body]);
    }
    const double begin = 1e-9 * static_cast<double>(motion.window.begin);
    state_.setTime(begin);
    system_.realize(state_, Stage::Velocity);
    write(state_, motion, false);
    std::vector<double> work(motion.count);
    std::vector<SpatialVec> rate(motion.count);
    const auto rate_of = [&](std::size_t i, const State& state) {
      return bodies_[motion.bodies[i].body].getBodyVelocity(state);
    };
    for (std::size_t i = 0; i < motion.count; ++i) rate[i] = rate_of(i, state_);
    integrator_->setReturnEveryInternalStep(true);
    integrator_->initialize(state_);
    for (double now = begin; now < begin + H;) {
      integrator_->stepTo(begin + H, begin + H);
      const State& reached = integrator_->getState();
      system_.realize(reached, Stage::Velocity);
      for (std::size_t i = 0; i < motion.count; ++i) {
        const SpatialVec next = rate_of(i, reached), mean = 0.5 * (rate[i] + next);
        const SpatialVec& F = load[motion.bodies[i].body];
        work[i] += (reached.getTime() - now) * (dot(F[0], mean[0]) + dot(F[1], mean[1]));
        rate[i] = next;
      }
      now = reached.getTime();
    }
    state_ = integrator_->getState();
    system_.realize(state_, Stage::Velocity);
    write(state_, motion, true);
    for (std::size_t i = 0; i < motion.count; ++i) {
      tandem_body_motion& body = motion.bodies[i];
      const SpatialVec& F = load[body.body];
      put(body.applied_impulse.force, H * F[1]);
      put(body.applied_impulse.torque, H * F[0]);
      body.applied_work = work[i];
      for (int k = 0; k < 3; ++k) {
        body.begin_acceleration[k] = body.end_acceleration[k] =
            (body.end_twist.velocity[k] - body.begin_twist.velocity[k]) / H;
        body.begin_angular_acceleration[k] = body.end_angular_acceleration[k] =
            (body.end_twist.angular_velocity[k] - body.begin_twist.angular_velocity[k]) / H;
      }
    }
  }

  void observe(tandem_bodies_frame& frame) {
    system_.realize(state_, Stage::Acceleration);
    for (std::size_t b = 0; b < frame.body_count; ++b) {
      put(frame.bodies[b].pose, bodies_[b].getBodyTransform(state_), last_[b]);
      const SpatialVec V = bodies_[b].getBodyVelocity(state_);
      put(frame.bodies[b].twist.velocity, V[1]);
      put(frame.bodies[b].twist.angular_velocity, V[0]);
    }
    Vector_<SpatialVec> reaction;  // on the child, about the joint's frame on the child
    matter_.calcMobilizerReactionForces(state_, reaction);
    for (std::size_t j = 0; j < frame.joint_count; ++j) {
      const MobilizedBody& body = bodies_[index_.at(joints_[j].at("child"))];
      const SpatialVec& R = reaction[body.getMobilizedBodyIndex()];
      put(frame.joints[j].reaction.force, R[1]);
      put(frame.joints[j].reaction.torque, R[0]);
      if (body.getNumU(state_) == 1) {
        frame.joints[j].coordinate = body.getOneQ(state_, 0);
        frame.joints[j].rate = body.getOneU(state_, 0);
      }
    }
    frame.energy = system_.calcEnergy(state_);
  }

  void save() { saved_ = state_; }
  void restore() { state_ = saved_; }

 private:
  MobilizedBody& holder(const std::string& name) {
    return name == "ground" ? static_cast<MobilizedBody&>(matter_.updGround()) : bodies_[index_.at(name)];
  }
  Transform start_of(const std::string& name) {
    return name == "ground" ? Transform() : start_[index_.at(name)];
  }

  void add_body(const tandem_configuration& c, std::size_t b, std::size_t depth) {
    if (!bodies_[b].isEmptyHandle()) return;
    const tandem_body& body = c.bodies[b];
    if (depth > c.body_count)
      throw Refusal{TANDEM_ERROR_SCENE, "closes a loop of joints",
                    std::string("mbd.bodies '") + body.name + "'", "this solver takes trees"};
    const double* I = body.inertia;
    const Body::Rigid rigid(MassProperties(body.mass, Vec3(0), Inertia(I[0], I[4], I[8], I[1], I[2], I[5])));
    const auto found = carried_.find(body.name);
    if (found == carried_.end()) {
      bodies_[b] = MobilizedBody::Free(matter_.updGround(), rigid);
      return;
    }
    const Json& joint = found->second;
    const std::string type = joint.at("type"), parent = joint.value("parent", "ground");
    if (parent != "ground") add_body(c, index_.at(parent), depth + 1);
    if (type == "free") {
      if (parent != "ground")
        throw Refusal{TANDEM_ERROR_SCENE, "is free of a body that moves",
                      "mbd.joints '" + joint["name"].get<std::string>() + "'",
                      "leave the joint out: a body without joints is free"};
      bodies_[b] = MobilizedBody::Free(matter_.updGround(), rigid);
      return;
    }
    // Both frames of the joint are one at the start, so that its coordinates are zero there.
    Transform frame(Rotation(), joint.contains("position") ? vec(joint["position"]) : start_[b].p());
    // A slider's axis is x, a pin's is z.
    if (joint.contains("axis"))
      frame.updR() = Rotation(UnitVec3(vec(joint["axis"])),
                              type == "prismatic" ? CoordinateAxis(XAxis) : CoordinateAxis(ZAxis));
    const Transform in_parent = ~start_of(parent) * frame, in_child = ~start_[b] * frame;
    MobilizedBody& carrier = holder(parent);
    if (type == "revolute")
      bodies_[b] = MobilizedBody::Pin(carrier, in_parent, rigid, in_child);
    else if (type == "prismatic")
      bodies_[b] = MobilizedBody::Slider(carrier, in_parent, rigid, in_child);
    else if (type == "spherical")
      bodies_[b] = MobilizedBody::Ball(carrier, in_parent, rigid, in_child);
    else
      bodies_[b] = MobilizedBody::Weld(carrier, in_parent, rigid, in_child);
    const int freedoms = type == "spherical" ? 3 : type == "fixed" ? 0 : 1;
    if (const double damping = joint.value("damping", 0.0); damping > 0)
      for (int i = 0; i < freedoms; ++i)
        Force::MobilityLinearDamper(forces_, bodies_[b], MobilizerUIndex(i), damping);
  }

  void add_force(const Json& force) {
    const double stiffness = force.value("stiffness", 0.0), damping = force.value("damping", 0.0);
    if (force.at("type") == "rotational_spring_damper") {
      for (const Json& joint : joints_) {
        if (joint.at("name") != force.at("joint")) continue;
        MobilizedBody& body = bodies_[index_.at(joint.at("child"))];
        Force::MobilityLinearSpring(forces_, body, MobilizerQIndex(0), stiffness, force.value("angle", 0.0));
        Force::MobilityLinearDamper(forces_, body, MobilizerUIndex(0), damping);
      }
      return;
    }
    const std::string a = force.value("body_a", "ground"), b = force.at("body_b");
    const Vec3 on_a = ~start_of(a) * vec(force.at("point_a")), on_b = ~start_of(b) * vec(force.at("point_b"));
    Force::TwoPointLinearSpring(forces_, holder(a), on_a, holder(b), on_b, stiffness, force.at("length"));
    if (damping > 0) Force::TwoPointLinearDamper(forces_, holder(a), on_a, holder(b), on_b, damping);
  }

  void start_rates(const tandem_configuration& c) {
    for (std::size_t b = 0; b < c.body_count; ++b)
      if (MobilizedBody::Free::isInstanceOf(bodies_[b])) {
        bodies_[b].setQToFitTransform(state_, start_[b]);
        bodies_[b].setUToFitVelocity(
            state_, SpatialVec(vec(c.bodies[b].twist.angular_velocity), vec(c.bodies[b].twist.velocity)));
      }
    for (const Json& joint : joints_)
      if (joint.contains("rate")) bodies_[index_.at(joint.at("child"))].setOneU(state_, 0, joint["rate"]);
  }

  void write(const State& state, tandem_motion_set& motion, bool end) {
    for (std::size_t i = 0; i < motion.count; ++i) {
      tandem_body_motion& body = motion.bodies[i];
      put(end ? body.end_pose : body.begin_pose, bodies_[body.body].getBodyTransform(state),
          last_[body.body]);
      const SpatialVec V = bodies_[body.body].getBodyVelocity(state);
      tandem_twist& twist = end ? body.end_twist : body.begin_twist;
      put(twist.velocity, V[1]);
      put(twist.angular_velocity, V[0]);
    }
  }

  MultibodySystem system_;
  SimbodyMatterSubsystem matter_;
  GeneralForceSubsystem forces_;
  Force::DiscreteForces loads_;
  double accuracy_;
  Json mbd_;
  std::map<std::string, std::size_t> index_;
  std::map<std::string, Json> carried_;  // child: its joint
  std::vector<Json> joints_;
  std::vector<Transform> start_;
  std::vector<Vec4> last_;
  std::vector<MobilizedBody> bodies_;
  std::unique_ptr<RungeKuttaMersonIntegrator> integrator_;
  State state_, saved_;
};

// Exceptions do not cross the C interface.
template <class Call>
int guarded(void* self, Call call) {
  try {
    call(*static_cast<Bodies*>(self));
    return TANDEM_OK;
  } catch (const Refusal& refusal) {
    return tandem_fail(refusal.code, refusal.what.c_str(), refusal.where.c_str(), refusal.hint.c_str());
  } catch (const std::exception& error) {
    return tandem_fail(TANDEM_ERROR_NUMERICS, error.what(), "Simbody", nullptr);
  }
}

const char* const features[] = {"joint:fixed",
                                "joint:revolute",
                                "joint:prismatic",
                                "joint:spherical",
                                "joint:free",
                                "joint.damping",
                                "joint.rate",
                                "force:spring_damper",
                                "force:rotational_spring_damper",
                                nullptr};

}  // namespace

int main(int argc, char** argv) {
  Bodies bodies;
  tandem_motion_solver table{};
  table.size = sizeof table;
  table.capabilities = TANDEM_CAN_PREDICT | TANDEM_CAN_ROLLBACK;
  table.features = features;
  table.configure = [](void* self, const tandem_configuration* c, tandem_motion_set* initial,
                       tandem_facts* facts) {
    return guarded(self, [&](Bodies& b) { b.configure(*c, *initial, facts); });
  };
  table.advance = [](void* self, const tandem_load_set* loads, tandem_motion_set* motion) {
    return guarded(self, [&](Bodies& b) { b.advance(*loads, *motion); });
  };
  table.predict = [](void* self, const tandem_window*, tandem_motion_set* motion) {
    return guarded(self, [&](Bodies& b) { b.predict(*motion); });
  };
  table.observe = [](void* self, tandem_bodies_frame* frame) {
    return guarded(self, [&](Bodies& b) { b.observe(*frame); });
  };
  table.report = [](void*, tandem_facts*) { return TANDEM_OK; };
  table.save = [](void* self) { return guarded(self, [](Bodies& b) { b.save(); }); };
  table.restore = [](void* self) { return guarded(self, [](Bodies& b) { b.restore(); }); };
  return tandem_motion_main(argc, argv, "simbody_bodies 1.0", &table, &bodies);
}
