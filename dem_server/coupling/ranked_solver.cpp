#include "dem_server/coupling/ranked_solver.hpp"

#include <algorithm>
#include <new>
#include <span>
#include <utility>

#include "common/cores.hpp"
#include "common/error.hpp"
#include "common/log.hpp"

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

// Each rank gets its part of the cores of one host, unless the user gives a number of threads.
protocol::Configuration of_rank(protocol::Configuration configuration, const Ranks& ranks, unsigned cores) {
  if (configuration.threads == 0) configuration.threads = std::max(1u, cores / ranks.size());
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

std::uint64_t LeadingSolver::capabilities() const {
  constexpr std::uint64_t not_over_ranks = protocol::can_checkpoint | protocol::can_observe_contacts;
  return own_->capabilities() & ~not_over_ranks;
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
protocol::Report LeadingSolver::report() {
  write(order_, Order::report);
  return on_all([&] { return own_->report(); });
}

namespace {

void execute(const protocol::Bytes& order, protocol::LoadSolver& own) {
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
    case Order::report:
      own.report();
      return;
    case Order::leave:
      return;
  }
}

}  // namespace

void follow(Ranks& ranks, protocol::LoadSolver& own) {
  const auto end = [&](const std::string& problem) {
    log::error("rank {} of {}: {}", ranks.rank(), ranks.size(), problem);
    ranks.abort(exit_status(ErrorCode::internal));
  };
  for (protocol::Bytes order;;) {
    ranks.broadcast(order);
    if (static_cast<Order>(order.front()) == Order::leave) return;
    try {
      execute(order, own);
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
