// Workers sleep until a round of tasks begins; the caller takes tasks as well and waits for the last worker.
#include "simulate/thread_pool.hpp"

#include "core/ranks/ranks.hpp"

namespace sysid {
namespace {

/// Sets a flag for as long as it lives, unless somebody else has.
struct Claim {
  explicit Claim(std::atomic_flag& flag) : flag(flag), won(!flag.test_and_set(std::memory_order_acquire)) {}
  ~Claim() {
    if (won) flag.clear(std::memory_order_release);
  }
  Claim(Claim const&) = delete;
  Claim& operator=(Claim const&) = delete;

  std::atomic_flag& flag;
  bool won;
};

}  // namespace

ThreadPool::ThreadPool(int threads) {
  for (int i = 1; i < threads; ++i) workers_.emplace_back([this] { work(); });
}

ThreadPool::~ThreadPool() {
  {
    std::lock_guard const lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void ThreadPool::run(int tasks, std::function<void(int)> const& task) {
  Claim const claim(busy_);
  ranks::Apart const apart;  // what threads do they do in any order
  if (!claim.won || workers_.empty() || tasks < 2) {
    for (int i = 0; i < tasks; ++i) task(i);
    return;
  }
  {
    std::lock_guard const lock(mutex_);
    task_ = &task;
    tasks_ = tasks;
    next_ = 0;
    failure_ = nullptr;
    working_ = static_cast<int>(workers_.size());
    ++round_;
  }
  wake_.notify_all();
  take_tasks();
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return working_ == 0; });
  task_ = nullptr;
  if (failure_) std::rethrow_exception(failure_);
}

void ThreadPool::work() {
  std::uint64_t seen = 0;
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return stop_ || round_ != seen; });
      if (stop_) return;
      seen = round_;
    }
    take_tasks();
    std::lock_guard const lock(mutex_);
    if (--working_ == 0) done_.notify_one();
  }
}

void ThreadPool::take_tasks() {
  for (int i = next_.fetch_add(1); i < tasks_; i = next_.fetch_add(1)) {
    try {
      (*task_)(i);
    } catch (...) {
      std::lock_guard const lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
  }
}

}  // namespace sysid
