#include "machine/team.hpp"

#include <cfenv>
#include <exception>

#ifndef _WIN32
#include <signal.h>
#include <unistd.h>
#endif

namespace softffd {

namespace {

/// Looks at what another thread will change: some 50 microseconds, many times what the parts of a step differ by. Then some that let
/// others run in between, half a millisecond: as long as many hosts take from one communication step to the next. Who sleeps wakes up late:
/// with 12^3 points and each internal step a communication step two threads took 1.25 of the time of one, and take 0.83.
constexpr int looks = 2000, patient_looks = 1000;

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ volatile("yield");
#endif
}

/// Returns when the value is no longer `old`.
template <class T>
void await_change(const std::atomic<T>& value, T old) {
  for (int look = 0; look < looks; ++look, pause())
    if (value.load(std::memory_order_acquire) != old) return;
  for (int look = 0; look < patient_looks; ++look, std::this_thread::yield())
    if (value.load(std::memory_order_acquire) != old) return;
  value.wait(old, std::memory_order_acquire);
}

#ifdef _WIN32
long this_process() { return 0; }
struct SignalsBlocked {};
#else
long this_process() { return getpid(); }
/// For the threads that are made meanwhile.
struct SignalsBlocked {
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before, nullptr); }
  sigset_t before;
};
#endif

}  // namespace

Team::Team(int members) : pieces_(members), helpers_(new std::vector<std::thread>), process_(this_process()) {
  helpers_->reserve(members - 1);
  [[maybe_unused]] const SignalsBlocked blocked;
  try {
    for (int own = 1; own < members; ++own) helpers_->emplace_back([this, own] { help(own); });
  } catch (const std::exception&) {  // no more to be had
  }
}

Team::~Team() {
  if (process_ != this_process()) {  // the child of a fork: nobody to wait for
    static_cast<void>(helpers_.release());
    return;
  }
  over_.store(true, std::memory_order_relaxed);
  round_.fetch_add(1, std::memory_order_release);
  round_.notify_all();
  for (std::thread& helper : *helpers_) helper.join();
}

void Team::run(const StepContext& context) {
  job_ = context;
  left_.store(members(), std::memory_order_relaxed);
  const unsigned round = round_.load(std::memory_order_relaxed) + 1;
  round_.store(round, std::memory_order_release);
  round_.notify_all();
  take_pieces(0, round);
  while (const int left = left_.load(std::memory_order_acquire)) await_change(left_, left);
}

/// A helper that comes late to a round finds all its pieces begun, and does not look at the context.
void Team::take_pieces(int own, unsigned round) {
  for (int n = 0; n < members(); ++n) {
    const int piece = (own + n) % members();
    unsigned before = round - 1;
    if (!pieces_[piece].round.compare_exchange_strong(before, round, std::memory_order_acq_rel)) continue;
    job_.act(job_.of, piece);
    if (left_.fetch_sub(1, std::memory_order_acq_rel) == 1) left_.notify_all();
  }
}

void Team::help(int own) {
  std::fesetenv(FE_DFL_ENV);
  for (unsigned round = 0;;) {
    await_change(round_, round);
    round = round_.load(std::memory_order_acquire);
    if (over_.load(std::memory_order_relaxed)) return;
    take_pieces(own, round);
  }
}

}  // namespace softffd
