#include "launch/conform/session.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "common/scene/parse.hpp"
#include "protocol/channel.hpp"

namespace tandem::conform {
namespace {

constexpr protocol::RunIdentity identity{0x6a75646765, 0};

double seconds_since(protocol::Clock::time_point begin) {
  return std::chrono::duration<double>(protocol::Clock::now() - begin).count();
}

}  // namespace

JudgedScene judged_scene(const std::string& text, const std::string& origin) {
  protocol::Configuration configuration;
  configuration.scene_text = text;
  configuration.origin = origin;
  configuration.backend = "auto";
  configuration.threads = 1;
  return {configuration, scene::parse(text, origin)};
}

protocol::Hello greet(Subject& subject, const Limits& limits) {
  const std::unique_ptr<Instance> instance = subject.start({});
  protocol::Remote remote(instance->take_channel(), subject.role(), identity);
  return remote.register_peer(0, limits.patience);
}

Session::Session(Subject& subject, const JudgedScene& scene, const Limits& limits,
                 const std::filesystem::path& state_folder)
    : instance_(subject.start(state_folder)) {
  remote_ = std::make_unique<protocol::Remote>(instance_->take_channel(), subject.role(), identity);
  remote_->set_patience(limits.patience);
  hello_ = remote_->register_peer(0, limits.patience);
  try {
    configured_ = remote_->configure(scene.configuration);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::scene) throw SceneRefused(error);
    throw;
  }
}

Window Session::next(double length) const {
  return {windows_, now_, now_ + to_nanoseconds(length)};
}

protocol::MotionSet Session::predict(double length) {
  remote_->start_predict(next(length));
  return remote_->finish_motion();
}

protocol::MotionSet Session::extrapolate(double length) {
  remote_->start_extrapolate(next(length));
  return remote_->finish_motion();
}

protocol::MotionSet Session::advance(const std::vector<protocol::BodyLoad>& loads, double length) {
  protocol::LoadSet set;
  set.window = next(length);
  set.bodies = loads;
  const auto begin = protocol::Clock::now();
  remote_->start_advance(set);
  protocol::MotionSet motion = remote_->finish_motion();
  longest_ = std::max(longest_, seconds_since(begin));
  now_ = set.window.end;
  ++windows_;
  return motion;
}

protocol::LoadSet Session::advance(const std::vector<protocol::BodyMotion>& paths, double length) {
  protocol::MotionSet set;
  set.window = next(length);
  set.bodies = paths;
  const auto begin = protocol::Clock::now();
  remote_->start_advance(set);
  protocol::LoadSet loads = remote_->finish_load();
  longest_ = std::max(longest_, seconds_since(begin));
  now_ = set.window.end;
  ++windows_;
  return loads;
}

void Session::save() {
  remote_->save();
  saved_now_ = now_;
  saved_windows_ = windows_;
}

void Session::restore() {
  remote_->restore();
  now_ = saved_now_;
  windows_ = saved_windows_;
}

protocol::Checkpoint Session::checkpoint(const std::string& path) {
  const protocol::Checkpoint file{windows_, now_, path};
  remote_->checkpoint(file);
  return file;
}

void Session::resume(const protocol::Checkpoint& file) {
  remote_->resume(file);
  now_ = file.time;
  windows_ = file.window;
}

}  // namespace tandem::conform
