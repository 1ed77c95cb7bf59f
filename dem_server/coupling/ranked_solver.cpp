#include "dem_server/coupling/ranked_solver.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <new>
#include <span>
#include <string>
#include <utility>

#include "common/cores.hpp"
#include "common/error.hpp"
#include "common/input_file.hpp"
#include "common/log.hpp"
#include "protocol/fd.hpp"

namespace tandem::dem {
namespace {

enum class Order : unsigned char {
  configure,
  advance,
  linearise,
  observe,
  snapshot,
  save,
  restore,
  checkpoint,
  resume,
  report,
  leave
};

void write(protocol::Bytes& order, Order which) {
  order.assign(1, static_cast<std::byte>(which));
}
template <class Argument>
void write(protocol::Bytes& order, Order which, const Argument& argument, protocol::Bytes& encoded) {
  protocol::encode(encoded, argument);
  write(order, which);
  order.insert(order.end(), encoded.begin(), encoded.end());
}

// All ranks find these errors at the same place: in the scene, or in the state, whose checks they combine.
bool is_of_all_ranks(const Error& error) {
  return error.code() == ErrorCode::scene || error.code() == ErrorCode::usage ||
         error.code() == ErrorCode::numerics || error.code() == ErrorCode::protocol;
}

Ranks::Bytes bytes_of(const std::filesystem::path& path) {
  constexpr std::uint64_t largest = std::uint64_t{1} << 40;
  const std::string text =
      read_input(path, {ErrorCode::resource, largest, "continue from another checkpoint"});
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

// A file for as long as this object; HDF5 opens none without a name.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::span<const std::byte> contents) {
    const protocol::Fd file(mkstemp(path_.data()));
    if (!file)
      throw Error(ErrorCode::internal, "no file can be made: " + std::string(strerror(errno)), path_);
    while (!contents.empty()) {
      const ssize_t count = ::write(file.get(), contents.data(), contents.size());
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) {
        unlink(path_.c_str());
        throw Error(ErrorCode::internal, "the state to continue from does not fit onto the disk", path_);
      }
      contents = contents.subspan(static_cast<std::size_t>(count));
    }
  }
  ~TemporaryFile() { unlink(path_.c_str()); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_ = std::filesystem::temp_directory_path() / "tandem_state_XXXXXX";
};

// Each rank gets its part of the cores of its host, unless the user gives a number of threads. Hosts are
// alike.
protocol::Configuration of_rank(protocol::Configuration configuration, const Ranks& ranks, unsigned cores) {
  if (configuration.threads == 0) configuration.threads = std::max(1u, cores / ranks.on_this_host());
  return configuration;
}

}  // namespace

LeadingSolver::LeadingSolver(Ranks& ranks, std::unique_ptr<protocol::LoadSolver> own)
    : ranks_(ranks), own_(std::move(own)) {}

LeadingSolver::~LeadingSolver() {
  if (apart_) ranks_.abort(exit_status(ErrorCode::internal));
  write(order_, Order::leave);
  ranks_.broadcast(order_);
}

// Sends order_ to the other ranks and executes `call` here.
template <class Call>
decltype(auto) LeadingSolver::on_all(Call call) {
  ranks_.broadcast(order_);
  try {
    return call();
  } catch (const Error& error) {
    apart_ = !is_of_all_ranks(error);
    throw;
  } catch (...) {
    apart_ = true;
    throw;
  }
}

protocol::Configured LeadingSolver::configure(const protocol::Configuration& given) {
  const protocol::Configuration configuration = of_rank(given, ranks_, usable_cores());
  write(order_, Order::configure, configuration, argument_);
  return on_all([&] { return own_->configure(configuration); });
}
const protocol::LoadSet& LeadingSolver::advance(const protocol::MotionSet& motion) {
  write(order_, Order::advance, motion, argument_);
  return on_all([&]() -> decltype(auto) { return own_->advance(motion); });
}
const protocol::TangentSet& LeadingSolver::linearise() {
  write(order_, Order::linearise);
  return on_all([&]() -> decltype(auto) { return own_->linearise(); });
}
const protocol::ParticlesFrame& LeadingSolver::observe() {
  write(order_, Order::observe);
  return on_all([&]() -> decltype(auto) { return own_->observe(); });
}
void LeadingSolver::snapshot() {
  write(order_, Order::snapshot);
  on_all([&] { own_->snapshot(); });
}
// The spheres are here since snapshot().
const protocol::ParticlesFrame& LeadingSolver::read_snapshot() {
  return own_->read_snapshot();
}
void LeadingSolver::save() {
  write(order_, Order::save);
  on_all([&] { own_->save(); });
}
void LeadingSolver::restore() {
  write(order_, Order::restore);
  on_all([&] { own_->restore(); });
}
void LeadingSolver::checkpoint(const protocol::Checkpoint& file) {
  write(order_, Order::checkpoint, file, argument_);
  on_all([&] { own_->checkpoint(file); });
}
// The others get a file in which this rank has found no fault. They may be on hosts that do not have it.
void LeadingSolver::resume(const protocol::Checkpoint& file) {
  own_->resume(file);
  Ranks::Bytes contents = bytes_of(file.path);
  write(order_, Order::resume, file, argument_);
  on_all([&] { ranks_.broadcast(contents); });
}
protocol::Report LeadingSolver::report() {
  write(order_, Order::report);
  return on_all([&] { return own_->report(); });
}

namespace {

void execute(const protocol::Bytes& order, Ranks& ranks, protocol::LoadSolver& own) {
  const std::span<const std::byte> argument = std::span(order).subspan(1);
  switch (static_cast<Order>(order.front())) {
    case Order::configure: {
      protocol::Configuration configuration;
      protocol::decode(argument, configuration);
      own.configure(configuration);
      return;
    }
    case Order::advance: {
      protocol::MotionSet motion;
      protocol::decode(argument, motion);
      own.advance(motion);
      return;
    }
    case Order::linearise:
      own.linearise();
      return;
    case Order::observe:
      own.observe();
      return;
    case Order::snapshot:
      return own.snapshot();
    case Order::save:
      return own.save();
    case Order::restore:
      return own.restore();
    case Order::checkpoint: {
      protocol::Checkpoint file;
      protocol::decode(argument, file);
      return own.checkpoint(file);
    }
    case Order::resume: {
      protocol::Checkpoint file;
      protocol::decode(argument, file);
      Ranks::Bytes contents;
      ranks.broadcast(contents);
      const TemporaryFile copy(contents);
      file.path = copy.path();
      try {
        return own.resume(file);
      } catch (const Error& error) {
        throw Error(ErrorCode::internal, error.what(), "resume");  // of this rank alone
      }
    }
    case Order::report:
      own.report();
      return;
    case Order::leave:
      return;
  }
}

}  // namespace

std::string warn_of_few_spheres(std::size_t spheres, unsigned gpus) {
  // In the time that ranks add to a micro step of a settled bed, 18 us and a rebuild of 1.2 ms in each 70,
  // one GPU moves so many spheres (docs/experiments/2026-11-rank-gpus.md).
  constexpr double spheres_of_messages = 180e3;
  const double taken_over = static_cast<double>(spheres) * (1 - 1.0 / gpus);  // by other GPUs than the first
  if (taken_over > spheres_of_messages) return {};
  return fmt::format(
      "{} spheres are few for {} GPUs: messages between them probably take longer than they save, and one "
      "GPU "
      "is faster (leave --ranks out)",
      spheres, gpus);
}

void expect_same_program(Ranks& ranks, std::uint64_t digest) {
  Ranks::Bytes bytes(sizeof digest);
  std::memcpy(bytes.data(), &digest, sizeof digest);
  const std::vector<Ranks::Bytes> all = ranks.exchange(std::vector<Ranks::Bytes>(ranks.size(), bytes));
  for (unsigned rank = 1; rank < ranks.size(); ++rank)
    if (all[rank] != all[0])
      throw Error(ErrorCode::usage,
                  "rank " + std::to_string(rank) + " runs another build of this program than rank 0",
                  "--hosts", "install the same tandem on all hosts, in the same folder");
}

void follow(Ranks& ranks, protocol::LoadSolver& own) {
  const auto end = [&](const std::string& problem) {
    log::error("rank {} of {}: {}", ranks.rank(), ranks.size(), problem);
    ranks.abort(exit_status(ErrorCode::internal));
  };
  for (protocol::Bytes order;;) {
    ranks.broadcast(order);
    if (static_cast<Order>(order.front()) == Order::leave) return;
    try {
      execute(order, ranks, own);
    } catch (const Error& error) {
      if (!is_of_all_ranks(error)) end(error.what());  // rank 0 reports the others
    } catch (const std::bad_alloc&) {
      end("out of memory");
    } catch (const std::exception& error) {
      end(error.what());
    }
  }
}

}  // namespace tandem::dem
