// A fixed team of threads that share index ranges. run() returns when all have finished. Results never depend
// on the number of threads: functors write to their own index, and tallies add exactly.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace tandem::particles {

class ThreadPool {
 public:
  explicit ThreadPool(unsigned threads);  // 0: all cores but those left free for other processes
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  unsigned size() const { return static_cast<unsigned>(workers_.size()) + 1; }
  // Calls task(thread) once on each thread 0..size()-1; thread 0 is the caller.
  void run(const std::function<void(unsigned)>& task);

 private:
  void work(unsigned thread);

  std::vector<std::thread> workers_;
  const std::function<void(unsigned)>* task_ = nullptr;
  std::atomic<unsigned> round_{0};
  std::atomic<unsigned> running_{0};
  std::atomic<bool> leaving_{false};
};

}  // namespace tandem::particles
