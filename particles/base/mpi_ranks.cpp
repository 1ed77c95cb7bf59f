#include "particles/base/mpi_ranks.hpp"

#include <mpi.h>
#include <sys/prctl.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

namespace tandem::particles {
namespace {

// MPI counts the bytes of a message by an int.
constexpr std::size_t longest_message = std::size_t{1} << 30;
enum Tag : int { of_exchange = 1, of_swap, of_broadcast };

using Pending = std::vector<MPI_Request>;

void send(std::span<const std::byte> bytes, unsigned rank, Tag tag, Pending& requests) {
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(bytes.size(), longest_message)))
    MPI_Isend(bytes.data(), static_cast<int>(std::min(bytes.size(), longest_message)), MPI_BYTE,
              static_cast<int>(rank), tag, MPI_COMM_WORLD, &requests.emplace_back());
}
void receive(std::span<std::byte> bytes, unsigned rank, Tag tag, Pending& requests) {
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(bytes.size(), longest_message)))
    MPI_Irecv(bytes.data(), static_cast<int>(std::min(bytes.size(), longest_message)), MPI_BYTE,
              static_cast<int>(rank), tag, MPI_COMM_WORLD, &requests.emplace_back());
}
void wait_for(Pending& requests) {
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

// MPI itself waits without rest, and would take a core from the other programs between two windows.
void rest_until_message(int tag) {
  using Clock = std::chrono::steady_clock;
  using namespace std::chrono_literals;
  const auto begin = Clock::now();
  for (int there = 0;;) {
    MPI_Iprobe(0, tag, MPI_COMM_WORLD, &there, MPI_STATUS_IGNORE);
    if (there != 0) return;
    const auto waited = Clock::now() - begin;
    if (waited < 20us) continue;
    std::this_thread::sleep_for(waited < 10ms ? 20us : 200us);
  }
}

}  // namespace

struct MpiRanks::Requests {
  std::vector<MPI_Request> all;
};

MpiRanks::MpiRanks(int& argc, char**& argv) : swapping_(std::make_unique<Requests>()) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // of mpirun
  int provided = 0, rank = 0, size = 1;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_SERIALIZED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  rank_ = static_cast<unsigned>(rank), size_ = static_cast<unsigned>(size);
  MPI_Comm of_host = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &of_host);
  MPI_Comm_size(of_host, &size);
  MPI_Comm_rank(of_host, &rank);
  MPI_Comm_free(&of_host);
  on_this_host_ = static_cast<unsigned>(size), place_on_host_ = static_cast<unsigned>(rank);
}

MpiRanks::~MpiRanks() {
  MPI_Finalize();
}

std::vector<Ranks::Bytes> MpiRanks::exchange(const std::vector<Bytes>& to) {
  std::vector<std::uint64_t> lengths_to(size_), lengths_from(size_);
  std::ranges::transform(to, lengths_to.begin(), [](const Bytes& bytes) { return bytes.size(); });
  MPI_Alltoall(lengths_to.data(), 1, MPI_UINT64_T, lengths_from.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD);
  std::vector<Bytes> from(size_);
  Pending requests;
  for (unsigned rank = 0; rank < size_; ++rank) {
    if (rank == rank_) continue;
    from[rank].resize(lengths_from[rank]);
    receive(from[rank], rank, of_exchange, requests);
    send(to[rank], rank, of_exchange, requests);
  }
  from[rank_] = to[rank_];
  wait_for(requests);
  return from;
}

void MpiRanks::begin_swap(std::span<const Parcel> to, std::span<const Parcel> from) {
  Pending& requests = swapping_->all;
  for (const Parcel& parcel : from) receive(parcel.bytes, parcel.rank, of_swap, requests);
  for (const Parcel& parcel : to) send(parcel.bytes, parcel.rank, of_swap, requests);
}

void MpiRanks::end_swap() {
  wait_for(swapping_->all);
  swapping_->all.clear();
}

void MpiRanks::sum(std::span<std::int64_t> values) {
  if (!values.empty())
    MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_INT64_T, MPI_SUM,
                  MPI_COMM_WORLD);
}

void MpiRanks::maximum(std::span<std::uint64_t> values) {
  if (!values.empty())
    MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_UINT64_T, MPI_MAX,
                  MPI_COMM_WORLD);
}

void MpiRanks::broadcast(Bytes& bytes) {
  if (rank_ == 0) {
    std::uint64_t length = bytes.size();
    Pending requests;
    for (unsigned rank = 1; rank < size_; ++rank) {
      send(std::as_bytes(std::span(&length, 1)), rank, of_broadcast, requests);
      send(bytes, rank, of_broadcast, requests);
    }
    return wait_for(requests);
  }
  rest_until_message(of_broadcast);
  std::uint64_t length = 0;
  Pending requests;
  receive(std::as_writable_bytes(std::span(&length, 1)), 0, of_broadcast, requests);
  wait_for(requests);
  requests.clear();
  bytes.resize(length);
  receive(bytes, 0, of_broadcast, requests);
  wait_for(requests);
}

void MpiRanks::abort(int status) {
  MPI_Abort(MPI_COMM_WORLD, status);
  std::abort();
}

}  // namespace tandem::particles
