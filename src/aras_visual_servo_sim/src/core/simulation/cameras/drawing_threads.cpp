#include "aras_visual_servo_sim/simulation/cameras/drawing_threads.hpp"

#include <algorithm>
#include <utility>

namespace aras_visual_servo_sim {

DrawingThreads::~DrawingThreads() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
  }
  begun_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

std::vector<std::exception_ptr> DrawingThreads::run(const std::vector<Task>& tasks, FrameDrawer& own) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    static const std::size_t processors = std::max(1u, std::thread::hardware_concurrency());  // asks the file system
    while (threads_.size() + 1 < std::min(tasks.size(), processors)) threads_.emplace_back([this] { work(); });
    thrown_.assign(tasks.size(), nullptr);
    next_ = finished_ = 0;
    tasks_ = &tasks;
    if (!tasks.empty()) next_ = 1;  // the first is the caller's, so that its renderers are those that are always used
  }
  begun_.notify_all();
  if (!tasks.empty()) doTask(0, own);
  doTasks(own);
  std::unique_lock<std::mutex> lock(mutex_);
  done_.wait(lock, [&] { return finished_ == tasks.size(); });
  tasks_ = nullptr;
  return std::move(thrown_);
}

/** What each thread but the calling one does. */
void DrawingThreads::work() {
  FrameDrawer drawer;
  for (;;) {
    {
      std::unique_lock<std::mutex> lock(mutex_);
      begun_.wait(lock, [this] { return ended_ || (tasks_ && next_ < tasks_->size()); });
      if (ended_) return;
    }
    doTasks(drawer);
  }
}

/** Takes one task after another until there is none. */
void DrawingThreads::doTasks(FrameDrawer& drawer) {
  for (;;) {
    std::size_t k = 0;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!tasks_ || next_ >= tasks_->size()) return;
      k = next_++;
    }
    doTask(k, drawer);
  }
}

void DrawingThreads::doTask(std::size_t k, FrameDrawer& drawer) {
  std::exception_ptr thrown;
  try {
    (*tasks_)[k](drawer);
  } catch (...) {
    thrown = std::current_exception();
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  thrown_[k] = thrown;
  if (++finished_ == tasks_->size()) done_.notify_all();
}

}  // namespace aras_visual_servo_sim
