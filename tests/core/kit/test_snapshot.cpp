#include "kit/snapshot.hpp"

#include "check.hpp"
#include "model/run.hpp"

using namespace softffd;

namespace {

Run at(double time) {
  Run run;
  run.physical.motion.time = time;
  run.physical.motion.x.setConstant(4, 3, time);
  return run;
}

}  // namespace

TEST(a_trial_goes_back_by_itself_and_allocates_nothing_where_the_buffer_has_the_size) {
  Run run = at(1), buffer = run;
  const double* place = buffer.physical.motion.x.data();
  {
    Snapshot snapshot(run, buffer);
    run.physical.motion.time = 2;
    run.physical.motion.x.setConstant(2);
    run.control.work = 5;
    CHECK(snapshot.before().physical.motion.time == 1 && buffer.physical.motion.x.data() == place);
  }
  CHECK(run.physical.motion.time == 1 && run.physical.motion.x(3, 2) == 1 && run.control.work == 0);
}

TEST(going_back_once_more_leaves_the_trial_open_and_what_is_kept_stays) {
  for (const bool kept : {false, true}) {
    Run run = at(1), buffer;
    {
      Snapshot snapshot(run, buffer);
      run.physical.motion.time = 2;
      snapshot.rollback();
      CHECK(run.physical.motion.time == 1);
      run.physical.motion.time = 3;
      if (kept) snapshot.commit();
    }
    CHECK(run.physical.motion.time == (kept ? 3 : 1));
  }
}

TEST(a_trial_of_the_path_keeps_what_was_learnt) {
  Run run = at(1);
  PhysicalState buffer;
  {
    Snapshot snapshot(run.physical, buffer);
    run.physical.motion.time = 2;
    run.physical.steps = 7;
    run.control.work = 5;
  }
  CHECK(run.physical.motion.time == 1 && run.physical.steps == 0 && run.control.work == 5);
}
