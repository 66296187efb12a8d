// A few threads that share numbered tasks. Which thread runs a task is left to chance, so tasks must not depend on it.
#pragma once
#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace sysid {

class ThreadPool {
 public:
  /// threads >= 1, the calling one included.
  explicit ThreadPool(int threads);
  ~ThreadPool();
  ThreadPool(ThreadPool const&) = delete;
  ThreadPool& operator=(ThreadPool const&) = delete;

  int threads() const { return static_cast<int>(workers_.size()) + 1; }
  /// task(0), ..., task(tasks - 1), each once; returns when all are done. A second caller meanwhile, or a task that calls, runs its
  /// tasks itself. The first exception of a task is thrown here.
  void run(int tasks, std::function<void(int)> const& task);

 private:
  void work();
  void take_tasks();

  std::vector<std::thread> workers_;
  std::atomic_flag busy_;  // set while a caller has the workers; no mutex, as one of its tasks may ask again
  std::mutex mutex_;
  std::condition_variable wake_, done_;
  std::function<void(int)> const* task_ = nullptr;
  int tasks_ = 0;
  std::atomic<int> next_ = 0;
  int working_ = 0;
  std::uint64_t round_ = 0;
  bool stop_ = false;
  std::exception_ptr failure_;
};

}  // namespace sysid
