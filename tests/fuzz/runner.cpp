#include "tests/fuzz/runner.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <new>
#include <optional>
#include <thread>

#include "common/error.hpp"

namespace tandem::fuzz {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

// Sanitizers are slow, and do not release freed memory at once.
#ifdef TANDEM_SANITIZED
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif
constexpr double slower = sanitized ? 4 : 1;
constexpr long most_for_one = 64 << 10, most_for_all = 512 << 10;  // allowed growth [KiB]

std::atomic<bool> interrupted = false;

class WorkFolder {
 public:
  WorkFolder() {
    const fs::path memory = "/dev/shm";
    std::string name =
        (access(memory.c_str(), W_OK) == 0 ? memory : fs::temp_directory_path()) / "fuzzing_XXXXXX";
    if (mkdtemp(name.data()) == nullptr)
      throw Error(ErrorCode::resource, std::string("cannot be created: ") + std::strerror(errno), name);
    path_ = name;
  }
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  fs::path sub(const std::string& name) const {
    fs::create_directories(path_ / name);
    return path_ / name;
  }

 private:
  fs::path path_;
};

// The inputs of a seed by number: first the entries of the corpus, then damaged ones.
class Inputs {
 public:
  Inputs(const TargetKind& kind, std::vector<Bytes> corpus, std::uint64_t seed)
      : kind_(kind), corpus_(std::move(corpus)), seed_(seed), mutator_(corpus_, kind.text) {}
  Inputs(const Inputs&) = delete;
  Inputs& operator=(const Inputs&) = delete;

  std::size_t whole() const { return corpus_.size(); }
  Fate make(std::uint64_t number, Bytes& out) const {
    if (number < corpus_.size()) {
      out = corpus_[number];
      return Fate::open;
    }
    Random random(seed_, number);
    mutator_.make(random, out);
    const Fate fate = kind_.finish ? kind_.finish(random, out) : Fate::open;
    const bool entry = fate == Fate::refused && std::ranges::find(corpus_, out) != corpus_.end();
    return entry ? Fate::open : fate;
  }

 private:
  const TargetKind& kind_;
  const std::vector<Bytes> corpus_;
  std::uint64_t seed_;
  Mutator mutator_;
};

enum class End { accepted, refused };

End take(Target& target, std::span<const std::byte> input, std::string* reason = nullptr) {
  // The copy has exactly the size of the input, so that the address sanitizer detects any access beyond it.
  const auto exact = std::make_unique_for_overwrite<std::byte[]>(input.size());
  if (!input.empty()) std::memcpy(exact.get(), input.data(), input.size());
  try {
    target.run({exact.get(), input.size()});
    return End::accepted;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::internal) throw Finding(std::string("an error of ours: ") + error.what());
    if (reason) *reason = error.what();
    return End::refused;
  }
}

long peak_memory() {  // [KiB]
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

// The progress that a worker process reports to its parent.
struct alignas(64) Seat {
  std::atomic<std::uint64_t> number{0}, next{0}, accepted{0}, refused{0};
  std::atomic<long> peak{0};
  std::atomic<bool> stop{false}, finished{false}, replace{false};
};

void work(const TargetKind& kind, const Inputs& inputs, const Plan& plan, Seat& seat,
          const fs::path& folder) {
  const auto target = kind.make(folder);
  Bytes input;
  const long start = peak_memory();
  long peak = seat.peak = start;
  for (std::uint64_t n = seat.next; n < plan.count && !seat.stop.load(std::memory_order_relaxed);
       n += plan.jobs) {
    seat.number.store(n, std::memory_order_relaxed);
    const Fate fate = inputs.make(n, input);
    std::string reason;
    const bool whole = n < inputs.whole();
    const bool accepted = take(*target, input, whole ? &reason : nullptr) == End::accepted;
    if (whole && !accepted) throw Finding("an entry of the corpus is refused: " + reason);
    if (accepted && fate == Fate::refused) throw Finding("is accepted, although it is damaged");
    (accepted ? seat.accepted : seat.refused).fetch_add(1, std::memory_order_relaxed);
    const long now = peak_memory();
    if (!sanitized && now - peak > most_for_one)
      throw Finding(fmt::format("{} bytes of input took {} MiB of memory", input.size(), (now - peak) >> 10));
    if (now != peak) seat.peak = peak = now;
    if (sanitized || now - start <= most_for_all) continue;
    if (!kind.leaks)
      throw Finding(fmt::format("memory has grown by {} MiB since the first input", (now - start) >> 10));
    seat.next = n + plan.jobs;
    seat.replace = true;
    return;
  }
}

[[noreturn]] void be_worker(const TargetKind& kind, const Inputs& inputs, const Plan& plan, Seat& seat,
                            const fs::path& folder) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGINT, SIG_IGN);
  try {
    work(kind, inputs, plan, seat, folder);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}: input {}: {}: {}\n", kind.name, seat.number.load(), typeid(e).name(), e.what());
    std::_Exit(1);
  }
  seat.finished = true;
  std::exit(0);  // a sanitizer reports leaks at the exit
}

struct Worker {
  pid_t pid = 0;
  Seat* seat = nullptr;
  fs::path folder;
  std::uint64_t number = 0;  // of the input that the worker processes
  Clock::time_point since;   // when it was first seen at this input
};

std::string how_it_ended(int status) {
  if (WIFSIGNALED(status))
    return fmt::format("killed by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
  return fmt::format("exit status {}", WEXITSTATUS(status));
}

// Waits for all workers. The first one that dies, or takes too long for one input, stops the others. Returns
// its seat.
const Seat* watch(std::vector<Worker>& workers, const Plan& plan, const std::function<void(Worker&)>& start) {
  const Clock::time_point begin = Clock::now();
  const Seat* failed = nullptr;
  std::size_t running = workers.size();
  while (running > 0) {
    std::this_thread::sleep_for(10ms);
    const Clock::time_point now = Clock::now();
    const bool over = failed || interrupted ||
                      (plan.seconds > 0 && now - begin > std::chrono::duration<double>(plan.seconds));
    for (Worker& worker : workers) {
      if (worker.pid == 0) continue;
      if (over) worker.seat->stop = true;
      int status = 0;
      if (waitpid(worker.pid, &status, WNOHANG) == worker.pid) {
        if (status == 0 && worker.seat->replace.exchange(false)) {
          start(worker);
          continue;
        }
        worker.pid = 0;
        --running;
        if (status == 0 && worker.seat->finished) continue;
        if (!failed) {
          fmt::print(stderr, "ended with {}\n", how_it_ended(status));
          failed = worker.seat;
        }
      } else if (const std::uint64_t number = worker.seat->number; number != worker.number) {
        worker.number = number, worker.since = now;
      } else if (now - worker.since > std::chrono::duration<double>(slower * plan.patience)) {
        fmt::print(stderr, "input {} takes longer than {} s\n", number, slower * plan.patience);
        kill(worker.pid, SIGKILL);
      }
    }
  }
  return failed;
}

fs::path save(const TargetKind& kind, const Plan& plan, std::uint64_t number, const Bytes& input) {
  const fs::path file = fmt::format("fuzz_{}_{}_{}.bin", kind.name, plan.seed, number);
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(input.data()), std::ssize(input));
  return fs::absolute(file);
}

}  // namespace

int run_plan(const TargetKind& kind, const Plan& plan) {
  const WorkFolder folder;
  const Inputs inputs(kind, kind.corpus(folder.sub("corpus")), plan.seed);
  const std::size_t bytes = plan.jobs * sizeof(Seat);
  void* shared = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED)
    throw Error(ErrorCode::resource, std::string("no shared memory: ") + std::strerror(errno));
  auto* seats = static_cast<Seat*>(shared);

  std::signal(SIGINT, [](int) { interrupted = true; });
  std::fflush(nullptr);
  const Clock::time_point begin = Clock::now();
  std::vector<Worker> workers;
  const auto start = [&](Worker& worker) {
    worker.since = Clock::now();
    worker.pid = fork();
    if (worker.pid == 0) be_worker(kind, inputs, plan, *worker.seat, worker.folder);
    if (worker.pid < 0) throw Error(ErrorCode::resource, std::string("no process: ") + std::strerror(errno));
  };
  for (unsigned job = 0; job < plan.jobs; ++job) {
    Seat* seat = new (seats + job) Seat;
    seat->next = job;
    workers.push_back({0, seat, folder.sub(std::to_string(job)), 0, begin});
    start(workers.back());
  }
  const Seat* failed = watch(workers, plan, start);
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();

  std::uint64_t accepted = 0, refused = 0;
  long peak = 0;
  for (const Worker& worker : workers) {
    accepted += worker.seat->accepted, refused += worker.seat->refused;
    peak = std::max(peak, worker.seat->peak.load());
  }
  const std::uint64_t done = accepted + refused;
  fmt::print("{}: {} inputs in {:.1f} s ({:.0f}/s), {} accepted, {} refused, peak memory {} MiB, seed {}\n",
             kind.name, done, seconds, static_cast<double>(done) / seconds, accepted, refused, peak >> 10,
             plan.seed);
  if (failed) {
    const std::uint64_t number = failed->number;
    Bytes input;
    inputs.make(number, input);
    fmt::print("{}: FINDING in input {} of seed {}, saved; again with: tandem_fuzz {} --input {}\n",
               kind.name, number, plan.seed, kind.name, save(kind, plan, number, input).string());
  } else if (done > 10 * inputs.whole() && refused == 0) {
    fmt::print("{}: FINDING: nothing was refused, so that nothing was looked at\n", kind.name);
    munmap(shared, bytes);
    return 1;
  }
  munmap(shared, bytes);
  return failed ? 1 : 0;
}

int run_file(const TargetKind& kind, const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Error(ErrorCode::usage, "cannot be read", file.string(), "give a saved input");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const WorkFolder folder;
  const auto target = kind.make(folder.sub("0"));
  std::string reason;
  try {
    const End end = take(*target, std::as_bytes(std::span(text)), &reason);
    fmt::print("{}: {}\n", kind.name, end == End::accepted ? "accepted" : "refused: " + reason);
    return 0;
  } catch (const std::exception& e) {
    fmt::print("{}: FINDING: {}: {}\n", kind.name, typeid(e).name(), e.what());
    return 1;
  }
}

}  // namespace tandem::fuzz
