#include "particles/base/thread_pool.hpp"

#include <algorithm>

#include "common/cores.hpp"

namespace tandem::particles {

namespace {

// Waits until `value` differs from `old`. Spins briefly, because the next parallel loop usually follows
// within microseconds; then sleeps, because other processes share these cores.
template <class T>
void wait_for_change(const std::atomic<T>& value, T old) {
  for (int spin = 0; spin < 2000; ++spin) {
    if (value.load(std::memory_order_acquire) != old) return;
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }
  value.wait(old, std::memory_order_acquire);
}

// Where there are enough cores, the coordinator and the other server spin while these threads work. Whenever
// one of them, or the system, takes the core of a thread, all threads wait for that thread at their barrier.
// A quarter of the cores is therefore left free (docs/experiments/2026-11-threads.md).
unsigned default_threads() {
  const unsigned cores = usable_cores();
  return cores >= cores_to_spin ? cores - std::max(2u, cores / 4) : cores;
}

}  // namespace

ThreadPool::ThreadPool(unsigned threads) {
  if (threads == 0) threads = default_threads();
  for (unsigned t = 1; t < threads; ++t) workers_.emplace_back([this, t] { work(t); });
}

ThreadPool::~ThreadPool() {
  leaving_ = true;
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  for (auto& worker : workers_) worker.join();
}

void ThreadPool::run(const std::function<void(unsigned)>& task) {
  if (workers_.empty()) return task(0);
  task_ = &task;
  running_.store(static_cast<unsigned>(workers_.size()), std::memory_order_relaxed);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  task(0);
  for (unsigned left; (left = running_.load(std::memory_order_acquire)) != 0;)
    wait_for_change(running_, left);
}

void ThreadPool::work(unsigned thread) {
  for (unsigned seen = 0;;) {
    wait_for_change(round_, seen);
    seen = round_.load(std::memory_order_acquire);
    if (leaving_) return;
    (*task_)(thread);
    if (running_.fetch_sub(1, std::memory_order_acq_rel) == 1) running_.notify_all();
  }
}

}  // namespace tandem::particles
