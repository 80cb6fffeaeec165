#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "aras_visual_servo_sim/simulation/cameras/frame_drawer.hpp"

namespace aras_visual_servo_sim {

/** Threads that draw at the same time, each with renderers of its own; they begin when they are first needed. */
class DrawingThreads {
 public:
  using Task = std::function<void(FrameDrawer&)>;

  DrawingThreads() = default;
  ~DrawingThreads();
  DrawingThreads(const DrawingThreads&) = delete;
  DrawingThreads& operator=(const DrawingThreads&) = delete;

  /** Does all tasks, at most one a processor at a time, the calling thread among those that do.
   *  @param own  what the calling thread draws with
   *  @return for each task what it threw, or null */
  std::vector<std::exception_ptr> run(const std::vector<Task>& tasks, FrameDrawer& own);

 private:
  void work();
  void doTasks(FrameDrawer& drawer);
  void doTask(std::size_t k, FrameDrawer& drawer);

  std::mutex mutex_;
  std::condition_variable begun_, done_;
  std::vector<std::thread> threads_;
  const std::vector<Task>* tasks_ = nullptr;  // null: there is nothing to do
  std::vector<std::exception_ptr> thrown_;
  std::size_t next_ = 0, finished_ = 0;  // of the tasks
  bool ended_ = false;
};

}  // namespace aras_visual_servo_sim
