// Checks of the conversation: start, refusals, answers in time, end.
#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "coordinator/start/processes.hpp"
#include "launch/conform/check.hpp"
#include "launch/conform/raw_end.hpp"
#include "launch/conform/sample.hpp"
#include "protocol/checks.hpp"
#include "protocol/facts.hpp"

namespace tandem::conform {
namespace {

using protocol::Kind;
using protocol::Role;

bool moves_bodies(Examination& e) {
  return e.subject().role() == Role::mbd;
}

// One window of the user's scene or of ours, whatever the side.
void advance(Examination& e, Session& session, double length) {
  if (moves_bodies(e))
    session.advance(sample_loads(e.scene(), session.configured().boundary), length);
  else
    session.advance(paths_at_rest(e.scene()), length);
}

void expect_failure(Examination& e, RawEnd& end, const std::string& what) {
  const protocol::Failure failure = end.refusal(what);
  e.expect(!failure.what.empty(), what + " was refused without a reason");
}

// The order for the window `window`, which begins at `begin`.
void order(Examination& e, RawEnd& end, const Window& window) {
  if (moves_bodies(e)) {
    protocol::LoadSet loads;
    loads.window = window;
    loads.bodies = sample_loads(e.scene(), end.configured().boundary);
    end.send(Kind::advance_mbd, loads, window.index);
  } else {
    protocol::MotionSet motion;
    motion.window = window;
    motion.bodies = paths_at_rest(e.scene());
    end.send(Kind::advance_dem, motion, window.index);
  }
}

// Throws the error of a coordinator that gets these facts.
void expect_facts(Examination& e, const std::string& text) {
  protocol::SolverFacts facts;
  protocol::decode_facts(e.subject().role(), text, facts);
}

Window window_at(std::uint64_t index, double begin, double length) {
  return {index, to_nanoseconds(begin), to_nanoseconds(begin + length)};
}

void hello(Examination& e) {
  const protocol::Hello greeting = greet(e.subject(), e.limits());
  e.expect(!greeting.program.empty(), "it does not say what program it is");
}

void start_state(Examination& e) {
  const auto session = e.open();
  expect_facts(e, session->configured().facts);
  if (!moves_bodies(e)) {
    e.expect(session->configured().boundary.empty(),
             "the answer to configure has motions of bodies, which only an mbd participant sends");
    return;
  }
  const std::vector<std::uint32_t> bodies = boundary_bodies(e.scene());
  protocol::MotionSet start;
  start.bodies = session->configured().boundary;
  e.compare("number of boundary bodies", static_cast<double>(start.bodies.size()),
            static_cast<double>(bodies.size()), 0, "");
  for (const std::uint32_t body : bodies) {
    const scene::Body& of_scene = e.scene().mbd->bodies[body];
    const protocol::BodyMotion& motion = motion_of(start, body);
    e.compare("position of " + of_scene.name, motion.begin_pose.p_WB, of_scene.pose.p_WB, 1e-9, "m");
    e.compare("rotation of " + of_scene.name + " against the scene",
              rotation_vector(motion.begin_pose.q_WB * of_scene.pose.q_WB.conjugate()), {}, 1e-9, "rad");
    e.compare("velocity of " + of_scene.name, motion.begin_twist.v_WB, of_scene.twist.v_WB, 1e-9, "m/s");
    e.compare("angular velocity of " + of_scene.name, motion.begin_twist.w_WB, of_scene.twist.w_WB, 1e-9,
              "rad/s");
  }
}

void answers_in_time(Examination& e) {
  const auto session = e.open();
  for (int i = 0; i < 50; ++i) advance(e, *session, H);
  e.compare("longest answer to a window", session->longest_answer(), 0,
            std::chrono::duration<double>(e.limits().answer).count(), "s");
}

void finish(Examination& e) {
  const auto session = e.open();
  advance(e, *session, H);
  expect_facts(e, session->remote().finish().facts);
  session->close();
  const auto ending = session->instance().ending(e.limits().leave);
  e.expect(ending.has_value(), "it did not leave after the report");
  if (ending) e.expect(*ending == launch::Process::good_ending, "after the report it " + *ending);
}

void closed_channel(Examination& e) {
  const auto session = e.open();
  advance(e, *session, H);
  session->close();
  e.expect(session->instance().ending(e.limits().leave).has_value(),
           fmt::format("it still runs {:.3g} s after the coordinator was gone",
                       std::chrono::duration<double>(e.limits().leave).count()));
}

void wrong_window(Examination& e) {
  for (const auto& [what, window] :
       {std::pair("window 1 in place of window 0", window_at(1, H, H)),
        std::pair("a window that begins 1 ms late", window_at(0, H, H)),
        std::pair("a window that ends before it begins", Window{0, {}, {-1000}})}) {
    RawEnd end(e.subject(), e.judged(), e.limits(), true);
    order(e, end, window);
    expect_failure(e, end, what);
  }
}

void wrong_order(Examination& e) {
  {
    RawEnd end(e.subject(), e.judged(), e.limits(), true);
    end.send(Kind::configure, e.judged().configuration);
    expect_failure(e, end, "a second configure");
  }
  RawEnd end(e.subject(), e.judged(), e.limits(), false);
  order(e, end, window_at(0, 0, H));
  expect_failure(e, end, "a window before configure");
}

void restore_unsaved(Examination& e) {
  RawEnd end(e.subject(), e.judged(), e.limits(), true);
  end.send(Kind::restore, protocol::Bytes{});
  expect_failure(e, end, "restore before the first save");
}

void not_finite(Examination& e) {
  RawEnd end(e.subject(), e.judged(), e.limits(), true);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Window window = window_at(0, 0, H);
  if (moves_bodies(e)) {
    protocol::LoadSet loads{window, {}, sample_loads(e.scene(), end.configured().boundary)};
    if (loads.bodies.empty()) return;
    loads.bodies.back().mean.torque.y = nan;
    end.send(Kind::advance_mbd, loads);
  } else {
    protocol::MotionSet motion{window, paths_at_rest(e.scene())};
    if (motion.bodies.empty()) return;
    motion.bodies.back().end_pose.p_WB.z = nan;
    end.send(Kind::advance_dem, motion);
  }
  expect_failure(e, end, "a window with a number that is not finite");
}

void unknown_body(Examination& e) {
  RawEnd end(e.subject(), e.judged(), e.limits(), true);
  const Window window = window_at(0, 0, H);
  if (moves_bodies(e)) {
    protocol::LoadSet loads{window, {}, {}};
    loads.bodies.emplace_back().body = 4711;
    end.send(Kind::advance_mbd, loads);
    expect_failure(e, end, "a load on a body that is not there");
  } else {
    protocol::MotionSet motion{window, {}};
    if (boundary_bodies(e.scene()).empty()) return;
    end.send(Kind::advance_dem, motion);
    expect_failure(e, end, "a window without the motion of a body with walls");
  }
}

void wrong_scene(Examination& e) {
  for (const std::string text : {"{\"tandem\": \"1.1\", \"name\": ", "{}"}) {
    RawEnd end(e.subject(), e.judged(), e.limits(), false);
    protocol::Configuration configuration = e.judged().configuration;
    configuration.scene_text = text;
    end.send(Kind::configure, configuration);
    expect_failure(e, end, "a scene that is none");
    e.expect(end.instance().ending(e.limits().leave).has_value(), "it did not leave after its failure");
  }
}

}  // namespace

void add_session_checks(std::vector<Check>& table) {
  const auto add = [&](const char* name, const char* meaning, std::uint64_t needs, const char* mbd,
                       const char* dem, bool any, void (*run)(Examination&)) {
    table.push_back({name, meaning, needs, mbd, dem, any, run, false, "basin"});
  };
  add("hello", "it registers within the time, with the protocol's version, its layout and the role", 0,
      "free_bodies", "tray", true, hello);
  add("start_state",
      "the answer to configure has the bodies with walls in the pose and with the velocity of the scene; its "
      "facts are a JSON object",
      0, "free_bodies", "tray", false, start_state);
  add("answers_in_time", "50 windows, each answered within the limit", 0, "free_bodies", "tray", true,
      answers_in_time);
  add("finish", "after finish it reports and leaves with status 0 within a second", 0, "free_bodies", "tray",
      true, finish);
  add("closed_channel", "it leaves within a second when the coordinator is gone", 0, "free_bodies", "tray",
      true, closed_channel);
  add("wrong_window", "a window with another index, begin or end than the next one is refused with a failure",
      0, "free_bodies", "tray", true, wrong_window);
  add("wrong_order", "a second configure, and a window before configure, are refused with a failure", 0,
      "free_bodies", "tray", true, wrong_order);
  add("restore_unsaved", "restore before the first save is refused with a failure", protocol::can_rollback,
      "free_bodies", "tray", true, restore_unsaved);
  add("not_finite", "a number that is not finite is refused with a failure", 0, "free_bodies", "tray", true,
      not_finite);
  add("unknown_body",
      "mbd: a load on a body that is not there, dem and sph: a missing motion is refused with a failure", 0,
      "free_bodies", "tray", true, unknown_body);
  add("wrong_scene", "a scene that is no scene is refused with a failure, after which it leaves", 0,
      "free_bodies", "tray", false, wrong_scene);
}

}  // namespace tandem::conform
