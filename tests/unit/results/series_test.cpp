#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <csignal>
#include <cstdlib>

#include "common/error.hpp"
#include "coordinator/results/results.hpp"
#include "coordinator/results/series/frame_file.hpp"
#include "coordinator/results/series/hdf5.hpp"
#include "coordinator/results/series/particle_series.hpp"
#include "tests/unit/results/toy_run.hpp"

namespace tandem::launch {
namespace {

// Python and h5py are independent of our code: what they read, other programs can read.
int check_xdmf(const std::filesystem::path& file, int steps) {
  const std::string command =
      "/usr/bin/python3 " TEST_FOLDER "/check_xdmf.py " + file.string() + " " + std::to_string(steps);
  return std::system(command.c_str());
}

const std::filesystem::path& prepared(const toy::Folder& folder) {
  std::filesystem::create_directories(folder / frames_folder);
  return folder;
}

void write_frames(Results& results, int frames) {
  for (int i = 0; i < frames; ++i) {
    const auto bodies = toy::bodies_frame(0.1 * i);
    // One lost per frame.
    const auto particles = toy::particles_frame(0.1 * i, 10 - static_cast<std::uint32_t>(i));
    results.write_frame(bodies.time, &bodies, &particles);
  }
  results.finish();
}

TEST(Series, EveryReferenceOfTheXdmfIsInTheHdf5) {
  const toy::Folder folder;
  Results results(folder, toy::machine(), {});
  write_frames(results, 3);
  // During the run, with the files open here.
  EXPECT_EQ(check_xdmf(folder / "particles.xdmf", 3), 0);
  EXPECT_EQ(check_xdmf(folder / "bodies.xdmf", 3), 0);
}

TEST(Series, TheCheckItselfCanFail) {
  const toy::Folder folder;
  Results results(folder, toy::machine(), {});
  write_frames(results, 2);
  std::string text = toy::text_of(folder / "particles.xdmf");
  text.replace(text.find("Dimensions=\"10 3\""), 17, "Dimensions=\"11 3\"");
  std::ofstream(folder / "particles.xdmf") << text;
  EXPECT_NE(check_xdmf(folder / "particles.xdmf", 2), 0);
}

TEST(Series, ParticlesReadBack) {
  const toy::Folder folder;
  {
    ParticleSeries series(prepared(folder), "particles");
    series.append(toy::particles_frame(0, 4));
    series.append(toy::particles_frame(0.5, 3));
    series.finish();
  }
  const Hdf5File file = Hdf5File::open(folder / "particles.h5");
  EXPECT_EQ(file.children("/"), (std::vector<std::string>{"frame_000000", "frame_000001"}));
  EXPECT_EQ(file.number_attribute("/frame_000001", "time"), 0.5);
  EXPECT_EQ(file.read_doubles("/frame_000001/position"), toy::particles_frame(0.5, 3).position);
  EXPECT_EQ(file.read_doubles("/frame_000001/speed"), (std::vector<double>{2.5, 2.5, 2.5}));
  EXPECT_EQ(file.read_indices("/frame_000000/id"), (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_FALSE(file.has("/frame_000002/position"));
}

TEST(Series, FrameWithoutParticles) {
  const toy::Folder folder;
  ParticleSeries series(prepared(folder), "particles");
  series.append(toy::particles_frame(0, 1));
  series.append(toy::particles_frame(1, 0));
  series.finish();
  EXPECT_EQ(check_xdmf(folder / "particles.xdmf", 2), 0);
}

TEST(Series, BodiesMoveAndTheGroundIsStoredOnce) {
  const toy::Folder folder;
  {
    Results results(folder, toy::machine(), {});
    write_frames(results, 3);
  }
  const Hdf5File file = Hdf5File::open(folder / "bodies.h5");
  EXPECT_TRUE(file.has("/frame_000002/wheel"));
  EXPECT_FALSE(file.has("/frame_000002/ground"));
  const auto start = file.read_doubles("/frame_000000/rod"), end = file.read_doubles("/frame_000002/rod");
  EXPECT_NEAR(end[2] - start[2], 0.2, 1e-15);
}

TEST(Series, IsReadableBeforeItsFirstFrame) {
  const toy::Folder folder;
  const Results results(folder, toy::machine(), {});
  EXPECT_EQ(check_xdmf(folder / "particles.xdmf", 0), 0);
  EXPECT_EQ(check_xdmf(folder / "bodies.xdmf", 0), 0);
  EXPECT_TRUE(Hdf5File::open(folder / "particles.h5").children("/").empty());
  EXPECT_EQ(Hdf5File::open(folder / "bodies.h5").children("/"), (std::vector<std::string>{"bodies"}));
}

TEST(Series, ADeathAtAnyMomentLeavesReadableFiles) {
  const toy::Folder folder;
  for (int last = 0; last < 60; ++last) {
    const std::filesystem::path run = folder / std::to_string(last);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      std::filesystem::create_directories(run / frames_folder);
      ParticleSeries series(run, "particles");
      // One system call after the other, until the alarm.
      const itimerval alarm{{0, 0}, {0, 300 + 150 * last}};
      std::signal(SIGALRM, SIG_DFL);
      setitimer(ITIMER_REAL, &alarm, nullptr);
      for (int i = 0;; ++i) series.append(toy::particles_frame(0.1 * i, 50));
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    const Hdf5File file = Hdf5File::open(run / "particles.h5");
    const auto frames = file.children("/");
    for (const std::string& name : frames)
      EXPECT_EQ(file.read_doubles("/" + name + "/position").size(), 150u);
    // Each frame under its name is complete, also where the index does not list it yet.
    for (const auto& entry : std::filesystem::directory_iterator(run / frames_folder))
      if (entry.path().extension() == ".h5") {
        EXPECT_EQ(Hdf5File::open(entry.path()).read_doubles("/position").size(), 150u);
      }
    const std::string xml = toy::text_of(run / "particles.xdmf");
    EXPECT_TRUE(xml.ends_with("</Xdmf>\n"));
  }
}

TEST(Series, FullDiskIsAResourceErrorWithThePath) {
  const toy::Folder folder;
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {  // a file size limit in place of a full disk
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{64 * 1024, 64 * 1024};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      ParticleSeries series(prepared(folder), "particles");
      series.append(toy::particles_frame(0, 10000));
    } catch (const Error& error) {
      const bool good = error.code() == ErrorCode::resource &&
                        error.where() == folder / "frames/particles_000000.h5" &&
                        error.problem().find("File too large") != std::string::npos;
      if (!good) std::fprintf(stderr, "%s\n", error.what());
      _exit(good ? 7 : 8);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

TEST(Series, AFrameThatDidNotReachTheDiskIsToldByTheNextCall) {
  const toy::Folder folder;
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    Results results(folder, toy::machine(), {});
    const std::string said = folder / "stderr.txt";
    if (std::freopen(said.c_str(), "w", stderr) == nullptr) _exit(1);
    const rlimit limit{64 * 1024, 64 * 1024};
    setrlimit(RLIMIT_FSIZE, &limit);
    const auto bodies = toy::bodies_frame(0.5);
    const auto particles = toy::particles_frame(0.5, 10000);
    try {
      results.write_frame(bodies.time, &bodies, &particles);
      results.finish();
    } catch (const Error& error) {
      const bool good = error.code() == ErrorCode::resource &&
                        error.where() == folder / "frames/particles_000000.h5" &&
                        error.problem().find("frame of t = 0.5 s") != std::string::npos;
      _exit(good && std::filesystem::file_size(said) == 0 ? 7 : 8);  // HDF5 prints nothing
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

}  // namespace
}  // namespace tandem::launch
