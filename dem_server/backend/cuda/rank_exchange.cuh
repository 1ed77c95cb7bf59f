// What ranks exchange while the spheres are on GPUs, one for each rank.
//
// On one host each rank stores its messages into the memory of the others and raises a flag there. All of
// that happens on the devices, so that no step waits for the host. Between hosts, or where devices do not
// reach each other, messages go through the memory of the host.
#pragma once

#include <cuda_runtime.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "dem_server/backend/cuda/rank_messages.cuh"
#include "dem_server/contact/ghosts.hpp"
#include "dem_server/contact/view.hpp"
#include "dem_server/laws/particle_names.hpp"
#include "particles/backend/cuda/device_exec.cuh"
#include "particles/backend/cuda/peer_memory.cuh"
#include "particles/base/check_cuda.cuh"
#include "particles/base/ranks.hpp"

namespace tandem::dem {

template <class Real, bool with_spin>
class CudaRankExchange {
 public:
  explicit CudaRankExchange(Ranks* ranks) : ranks_(ranks) {}
  ~CudaRankExchange() { cudaFreeHost(pinned_); }
  CudaRankExchange(const CudaRankExchange&) = delete;
  CudaRankExchange& operator=(const CudaRankExchange&) = delete;

  template <class Exec>
  void exchange(Exec& exec, std::span<const ExchangedArray> arrays) {
    begin();
    peers_ ? exchange_by_peers(exec, arrays) : exchange_by_host(exec, arrays);
  }

  template <class Exec, class Buffer>
  void connect(Exec& exec, const std::vector<GhostLink>& links, const Buffer& send) {
    begin();
    links_ = links;
    messages_.send = send.data();
    messages_.ranks = ranks_->size();
    messages_.sent = messages_.ghosts = 0;
    for (const GhostLink& link : links) {
      messages_.sent = std::max(messages_.sent, link.send.end);
      messages_.ghosts += link.ghosts.end - link.ghosts.begin;
    }
    if (messages_.number == nullptr) {
      number_.resize(2);
      messages_.number = number_.data();
    }
    peers_ ? open_peers(exec) : open_host_memory(exec);
  }

  template <class Exec>
  void refresh(Exec& exec, const View<Real>& view, std::uint32_t side) {
    if (messages_.number == nullptr) return;  // before the first lists there are no ghosts
    pass(exec, view, nullptr, 0, side);
  }
  template <class Exec>
  void end_step(Exec& exec, const View<Real>& view) {
    const unsigned side = exec.step_side();
    pass(exec, view, view.window->progress + (side ^ 1), side, 0);
  }

 private:
  using Ghost = GhostState<Real, with_spin>;
  using Outgoing = typename RankMessages<Real, with_spin>::Outgoing;
  using Incoming = typename RankMessages<Real, with_spin>::Incoming;
  template <class T>
  using Buffer = particles::DeviceExec::Buffer<T>;
  static constexpr unsigned threads = 128, most_blocks = 528;

  void begin() {
    if (opened_ != nullptr) return;
    peers_ = all_reach_each_other(*ranks_);
    opened_ = std::make_unique<OpenedMemory>();
  }
  template <class Exec>
  static void wait(Exec& exec) {
    check_cuda(cudaStreamSynchronize(exec.stream()), "copying between ranks");
  }

  template <class Exec>
  static void copy(Exec& exec, void* to, const void* from, std::size_t bytes) {
    if (bytes > 0)
      check_cuda(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDefault, exec.stream()), "copying between ranks");
  }
  static std::size_t length(const ExchangedArray& array, Range range) {
    return (std::size_t{range.end} - range.begin) * array.entry;
  }

  // Others read from a copy: while they do, this rank goes on. It fills the same copy again after it has got
  // their messages of the next exchange, before which they wait for what they read.
  template <class Exec>
  void exchange_by_peers(Exec& exec, std::span<const ExchangedArray> arrays) {
    struct Offer {
      PeerAddress address;
      std::uint64_t at = 0;
    };
    SharedMemory& shared = offered_[turn_++ % 2];
    const auto padded = [](std::size_t bytes) { return (bytes + 15) / 16 * 16; };
    std::vector<Offer> offers(ranks_->size());
    std::uint64_t bytes = 0;
    for (unsigned rank = 0; rank < ranks_->size(); ++rank) {
      offers[rank].at = bytes;
      if (rank == ranks_->rank()) continue;
      for (const ExchangedArray& array : arrays) bytes += padded(length(array, array.to[rank]));
    }
    shared.reserve(std::max<std::uint64_t>(bytes, 16));
    for (unsigned rank = 0; rank < ranks_->size(); ++rank) {
      offers[rank].address = shared.address();
      if (rank == ranks_->rank()) continue;
      std::byte* at = shared.data() + offers[rank].at;
      for (const ExchangedArray& array : arrays) {
        const std::size_t count = length(array, array.to[rank]);
        copy(exec, at, array.out + array.to[rank].begin * array.entry, count);
        at += padded(count);
      }
    }
    wait(exec);
    const std::vector<Offer> offered = exchange_values<Offer>(*ranks_, offers);
    for (unsigned rank = 0; rank < ranks_->size(); ++rank) {
      if (rank == ranks_->rank()) continue;
      std::size_t all = 0;
      for (const ExchangedArray& array : arrays) all += length(array, array.from[rank]);
      if (all == 0) continue;
      const std::byte* at = opened_->open(offered[rank].address) + offered[rank].at;
      for (const ExchangedArray& array : arrays) {
        const std::size_t count = length(array, array.from[rank]);
        copy(exec, array.in + array.from[rank].begin * array.entry, at, count);
        at += padded(count);
      }
    }
    wait(exec);
  }
  template <class Exec>
  void exchange_by_host(Exec& exec, std::span<const ExchangedArray> arrays) {
    for (const ExchangedArray& array : arrays) {
      std::vector<Ranks::Bytes> parts(ranks_->size());
      for (unsigned rank = 0; rank < ranks_->size(); ++rank) {
        if (rank == ranks_->rank()) continue;
        parts[rank].resize(length(array, array.to[rank]));
        copy(exec, parts[rank].data(), array.out + array.to[rank].begin * array.entry, parts[rank].size());
      }
      wait(exec);
      const std::vector<Ranks::Bytes> received = ranks_->exchange(parts);
      for (unsigned rank = 0; rank < ranks_->size(); ++rank)
        if (rank != ranks_->rank())
          copy(exec, array.in + array.from[rank].begin * array.entry, received[rank].data(),
               length(array, array.from[rank]));
      wait(exec);
    }
  }

  // Memory for messages of others: reports of all ranks for even and odd messages, then ghosts likewise.
  std::size_t ghosts_at(unsigned which) const {
    return 2 * std::size_t{messages_.ranks} * sizeof(RankReport) + which * messages_.ghosts * sizeof(Ghost);
  }
  std::size_t report_at(unsigned which, unsigned rank) const {
    return (std::size_t{which} * messages_.ranks + rank) * sizeof(RankReport);
  }

  template <class Exec>
  void open_peers(Exec& exec) {
    inbox_.reserve(ghosts_at(2));
    // Where a rank puts its messages.
    struct Invitation {
      PeerAddress address;
      std::uint64_t ghosts[2]{}, report[2]{};
    };
    std::vector<Invitation> invitations(ranks_->size());
    std::uint32_t before = 0;
    for (unsigned rank = 0; rank < ranks_->size(); ++rank) {
      invitations[rank].address = inbox_.address();
      for (const unsigned which : {0u, 1u}) invitations[rank].report[which] = report_at(which, rank);
    }
    std::vector<Incoming> incoming;
    for (const GhostLink& link : links_) {
      Incoming from{link.ghosts, {}};
      for (const unsigned which : {0u, 1u}) {
        const std::size_t at = ghosts_at(which) + before * sizeof(Ghost);
        invitations[link.rank].ghosts[which] = at;
        from.from[which] = reinterpret_cast<const Ghost*>(inbox_.data() + at);
      }
      incoming.push_back(from);
      before += link.ghosts.end - link.ghosts.begin;
    }
    const std::vector<Invitation> invited = exchange_values<Invitation>(*ranks_, invitations);
    std::vector<RankReport*> report_to;
    for (const unsigned which : {0u, 1u})
      for (unsigned rank = 0; rank < ranks_->size(); ++rank)
        report_to.push_back(reinterpret_cast<RankReport*>(open(invited, rank) + invited[rank].report[which]));
    std::vector<Outgoing> outgoing;
    for (const GhostLink& link : links_) {
      Outgoing to{link.send, {}};
      for (const unsigned which : {0u, 1u})
        to.to[which] = reinterpret_cast<Ghost*>(open(invited, link.rank) + invited[link.rank].ghosts[which]);
      outgoing.push_back(to);
    }
    tell_device(exec, incoming, outgoing, report_to);
    for (const unsigned which : {0u, 1u})
      messages_.reports[which] = reinterpret_cast<RankReport*>(inbox_.data() + report_at(which, 0));
  }
  template <class Invitation>
  std::byte* open(const std::vector<Invitation>& invited, unsigned rank) {
    return rank == ranks_->rank() ? inbox_.data() : opened_->open(invited[rank].address);
  }

  // Memory of the host, which the device reads and writes: what comes in as above, then the report of this
  // rank, then the ghosts that go out.
  template <class Exec>
  void open_host_memory(Exec& exec) {
    const std::size_t report = ghosts_at(2), out = report + sizeof(RankReport),
                      bytes = out + messages_.sent * sizeof(Ghost);
    if (bytes > pinned_bytes_) {
      wait(exec);
      cudaFreeHost(pinned_);
      void* fresh = nullptr;
      pinned_bytes_ = bytes + bytes / 4;
      check_cuda(cudaMallocHost(&fresh, pinned_bytes_), "allocating memory for messages");
      pinned_ = static_cast<std::byte*>(fresh);
    }
    std::memset(pinned_, 0, bytes);
    own_report_ = reinterpret_cast<RankReport*>(pinned_ + report);
    own_report_->number = sent_number_;
    out_ = reinterpret_cast<Ghost*>(pinned_ + out);
    std::vector<Incoming> incoming;
    std::vector<Outgoing> outgoing;
    std::uint32_t before = 0;
    for (const GhostLink& link : links_) {
      Incoming from{link.ghosts, {}};
      Outgoing to{link.send, {}};
      for (const unsigned which : {0u, 1u}) {
        from.from[which] = reinterpret_cast<const Ghost*>(pinned_ + ghosts_at(which)) + before;
        to.to[which] = out_ + link.send.begin;
      }
      incoming.push_back(from), outgoing.push_back(to);
      before += link.ghosts.end - link.ghosts.begin;
    }
    tell_device(exec, incoming, outgoing, std::vector<RankReport*>(2 * ranks_->size(), own_report_));
    for (const unsigned which : {0u, 1u})
      messages_.reports[which] = reinterpret_cast<RankReport*>(pinned_ + report_at(which, 0));
  }

  template <class Exec>
  void tell_device(Exec& exec, const std::vector<Incoming>& incoming, const std::vector<Outgoing>& outgoing,
                   const std::vector<RankReport*>& report_to) {
    exec.upload(incoming_, std::span<const Incoming>(incoming));
    exec.upload(outgoing_, std::span<const Outgoing>(outgoing));
    exec.upload(report_to_, std::span<RankReport* const>(report_to));
    messages_.incoming = incoming_.data(), messages_.outgoing = outgoing_.data();
    for (const unsigned which : {0u, 1u})
      messages_.report_to[which] = report_to_.data() + which * ranks_->size();
  }

  template <class Exec>
  void pass(Exec& exec, const View<Real>& view, const StepProgress* gate, unsigned step_side,
            std::uint32_t side) {
    const auto blocks = [](std::uint32_t n) {
      return std::clamp((n + threads - 1) / threads, 1u, most_blocks);
    };
    send_kernel<Real, with_spin>
        <<<blocks(messages_.sent), threads, 0, exec.stream()>>>(view, messages_, gate, step_side, side);
    check_cuda(cudaGetLastError(), "sending ghosts");
    if (!peers_ && !swap_through_host(exec)) return;
    receive_kernel<Real, with_spin>
        <<<blocks(messages_.ghosts), threads, 0, exec.stream()>>>(view, messages_, gate, step_side, side);
    check_cuda(cudaGetLastError(), "receiving ghosts");
  }
  // False where the step has not begun, which is so on all ranks.
  template <class Exec>
  bool swap_through_host(Exec& exec) {
    wait(exec);
    if (own_report_->number == sent_number_) return false;
    sent_number_ = own_report_->number;
    const unsigned which = sent_number_ & 1;
    std::vector<Ranks::Parcel> to, from;
    auto* at = reinterpret_cast<Ghost*>(pinned_ + ghosts_at(which));
    for (const GhostLink& link : links_) {
      const std::uint32_t sent = link.send.end - link.send.begin,
                          ghosts = link.ghosts.end - link.ghosts.begin;
      if (sent > 0)
        to.push_back({link.rank, std::as_writable_bytes(std::span(out_ + link.send.begin, sent))});
      if (ghosts > 0) from.push_back({link.rank, std::as_writable_bytes(std::span(at, ghosts))});
      at += ghosts;
    }
    ranks_->begin_swap(to, from);
    std::vector<std::uint64_t> most{own_report_->max_speed2, ~own_report_->culprit, own_report_->error};
    ranks_->maximum(most);
    RankReport all{sent_number_, static_cast<std::uint32_t>(most[0]), own_report_->error,
                   ~static_cast<std::uint32_t>(most[1])};
    if (most[2] != 0) all.error = any_of_ranks(*ranks_, all.error);
    ranks_->end_swap();
    auto* const reports = reinterpret_cast<RankReport*>(pinned_ + report_at(which, 0));
    std::fill_n(reports, ranks_->size(), all);
    return true;
  }

  Ranks* ranks_;
  bool peers_ = false;
  std::vector<GhostLink> links_;
  RankMessages<Real, with_spin> messages_;
  Buffer<Incoming> incoming_;
  Buffer<Outgoing> outgoing_;
  Buffer<RankReport*> report_to_;
  Buffer<std::uint32_t> number_;
  // Where all reach each other:
  std::unique_ptr<OpenedMemory> opened_;
  SharedMemory inbox_, offered_[2];
  unsigned turn_ = 0;
  // Elsewhere:
  std::byte* pinned_ = nullptr;
  std::size_t pinned_bytes_ = 0;
  RankReport* own_report_ = nullptr;
  Ghost* out_ = nullptr;
  std::uint32_t sent_number_ = 0;
};

}  // namespace tandem::dem
