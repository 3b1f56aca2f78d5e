#include "calls/registry.hpp"

#include "check.hpp"

using softffd::fmi::Registry;

namespace {

int alive = 0;

struct Thing {
  explicit Thing(int number) : number(number) { ++alive; }
  ~Thing() { --alive; }
  Thing(const Thing&) = delete;
  int number;
};

constinit Registry<Thing> things;

Thing* adopt(int number) { return things.adopt(std::make_unique<Thing>(number)); }

}  // namespace

TEST(a_handle_leads_to_its_object_until_it_is_released) {
  Thing *one = adopt(1), *two = adopt(2);
  CHECK(things.live(one).get() == one && things.live(two).get() == two && alive == 2);
  things.release(one);
  CHECK(!things.live(one) && things.live(two).get() == two && alive == 1);
  things.release(two);
  CHECK(!things.live(two) && alive == 0);
}

TEST(an_object_in_use_outlives_its_release) {
  Thing* one = adopt(1);
  {
    const std::shared_ptr<Thing> used = things.live(one);
    things.release(one);
    CHECK(!things.live(one) && used->number == 1 && alive == 1);
  }
  CHECK(alive == 0);
}

TEST(handles_that_nobody_was_given_are_not_looked_into) {
  CHECK(!things.live(nullptr) && !things.live(reinterpret_cast<void*>(64)));
  Thing* one = adopt(1);
  for (const void* foreign : {static_cast<const void*>(nullptr), static_cast<const void*>(one + 1), static_cast<const void*>(&alive)}) {
    CHECK(!things.live(foreign));
    things.release(foreign);
  }
  CHECK(things.live(one).get() == one && alive == 1);
  things.release(one);
  things.release(one);
  CHECK(alive == 0);
}

TEST(those_that_fulfil_a_condition_are_released_together) {
  for (int number : {1, 2, 3, 4, 5}) adopt(number);
  Thing* kept = adopt(6);
  things.release_if([](const Thing& thing) { return thing.number < 6; });
  CHECK(alive == 1 && things.live(kept).get() == kept);
  things.release_if([](const Thing&) { return true; });
  CHECK(alive == 0 && !things.live(kept));
  Thing* later = adopt(7);  // after the table has gone with the last object
  CHECK(things.live(later).get() == later);
  things.release(later);
}
