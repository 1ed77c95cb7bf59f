// One run of the participant under the judge: registered, configured, window after window.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/scene/model.hpp"
#include "launch/conform/subject.hpp"
#include "protocol/remote.hpp"

namespace tandem::conform {

struct JudgedScene {
  protocol::Configuration configuration;
  scene::Scene scene;
};
// A scene of the judge.
JudgedScene judged_scene(const std::string& text, const std::string& origin);

inline constexpr double shortest_long_run = 2;  // [s]

struct Limits {
  std::chrono::milliseconds patience{10'000};  // longest wait for an answer
  std::chrono::milliseconds answer{1'000};     // longest answer that counts as in time
  std::chrono::milliseconds leave{1'000};      // time in which a participant leaves
  double long_run = 0;  // simulated time of the checks of long runs [s]; 0: those that are named take 2 s
};

// The participant does not take the scene, and says so by its name.
class SceneRefused : public Error {
 public:
  explicit SceneRefused(const Error& error)
      : Error(error.code(), error.problem(), error.where(), error.hint()) {}
};

// Registers the participant, and leaves it.
protocol::Hello greet(Subject& subject, const Limits& limits);

class Session {
 public:
  // Throws SceneRefused where the participant refuses the scene.
  Session(Subject& subject, const JudgedScene& scene, const Limits& limits,
          const std::filesystem::path& state_folder);
  // A run that goes on from a state on disk begins at its time.
  void resume(const protocol::Checkpoint& file);

  protocol::Remote& remote() { return *remote_; }
  Instance& instance() { return *instance_; }
  const protocol::Hello& hello() const { return hello_; }
  const protocol::Configured& configured() const { return configured_; }
  Nanoseconds now() const { return now_; }
  double time() const { return to_seconds(now_); }
  std::uint64_t windows() const { return windows_; }
  double longest_answer() const { return longest_; }  // of an advance [s]

  // mbd; lengths of windows [s]
  protocol::MotionSet predict(double length);
  protocol::MotionSet extrapolate(double length);
  protocol::MotionSet advance(const std::vector<protocol::BodyLoad>& loads, double length);
  protocol::BodiesFrame bodies() { return remote_->observe_bodies(now_); }
  // dem
  protocol::LoadSet advance(const std::vector<protocol::BodyMotion>& paths, double length);
  protocol::ParticlesFrame particles() { return remote_->observe_particles(now_); }
  // both
  void save();
  void restore();
  protocol::Checkpoint checkpoint(const std::string& path);

  // Closes the channel, as a coordinator that ends without a word.
  void close() { remote_.reset(); }

 private:
  Window next(double length) const;

  std::unique_ptr<Instance> instance_;
  std::unique_ptr<protocol::Remote> remote_;
  protocol::Hello hello_;
  protocol::Configured configured_;
  Nanoseconds now_, saved_now_;
  std::uint64_t windows_ = 0, saved_windows_ = 0;
  double longest_ = 0;
};

}  // namespace tandem::conform
