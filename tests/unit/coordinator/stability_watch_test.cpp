// What the coordinator's restart file says about windows and their stability is checked before it is used.
#include "coordinator/watch/stability_watch.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <functional>

#include "coordinator/window/window_control.hpp"

namespace tandem::launch {
namespace {

class KeptFigures : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }

  // The problem with a state of `write` for `read`.
  std::string refusal(const std::function<void(Archive&)>& write, const std::function<void(Archive&)>& read) {
    {
      StateWriter out(file_, "toy", 1);
      Archive archive(out);
      write(archive);
      out.commit();
    }
    const StateReader in(file_, "toy", 1);
    Archive archive(in);
    try {
      read(archive);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::resource);
      EXPECT_EQ(error.where(), file_.string());
      return error.problem();
    }
    return "none";
  }

 private:
  const std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("tandem_figures_" + std::to_string(getpid()));
};

TEST_F(KeptFigures, OfStabilityAreThoseOfABodyThatVibrates) {
  scene::Scene scene;
  scene.mbd.emplace().bodies.resize(2);
  const auto said = [&](std::uint32_t body, const StabilityFigures& figures) {
    return refusal(
        [&](Archive& archive) {
          std::map<std::uint32_t, StabilityFigures> kept{{body, figures}};
          double window = INFINITY;
          archive("stability/figures", kept);
          archive("stability/window", window);
        },
        [&](Archive& archive) { StabilityWatch(scene).save_or_restore(archive, 10); });
  };
  const std::string begin = "'stability/figures' is damaged: ";
  const StabilityFigures sound{
      .now = {0.5, 0.1, 0.9}, .worst = {1, 0.1, 1.2}, .limit = 0.8, .windows_beyond = 10};
  EXPECT_EQ(said(1, sound), "none");
  EXPECT_EQ(said(2, sound), begin + "there is no such body");
  for (const double wrong : {std::nan(""), -1.0, static_cast<double>(INFINITY)})
    for (double Vibration::*figure : {&Vibration::omega_H, &Vibration::zeta}) {
      StabilityFigures damaged = sound;
      damaged.worst.*figure = wrong;
      EXPECT_EQ(said(1, damaged), begin + "no body vibrates like that") << wrong;
    }
  StabilityFigures damaged = sound;
  damaged.now.growth = 2;
  EXPECT_EQ(said(1, damaged), begin + "the worst vibration is not the worst");
  damaged = sound;
  damaged.limit = std::nan("");
  EXPECT_EQ(said(1, damaged), begin + "the limit of stability is no number of at least 0");
  damaged = sound;
  damaged.windows_beyond = 11;
  EXPECT_EQ(said(1, damaged), begin + "more windows are beyond the limit than there were");
}

TEST_F(KeptFigures, OfFixedWindowsHaveTheLengthOfTheScene) {
  const auto said = [&](double length) {
    scene::Coupling of_file, of_scene;
    of_file.window = length, of_scene.window = 1e-3;
    return refusal([&](Archive& archive) { WindowControl(of_file).save_or_restore(archive); },
                   [&](Archive& archive) { WindowControl(of_scene).save_or_restore(archive); });
  };
  EXPECT_EQ(said(1e-3), "none");
  EXPECT_EQ(said(2e-3), "'window_control/length' is damaged: the window is not coupling.window of the scene");
}

}  // namespace
}  // namespace tandem::launch
