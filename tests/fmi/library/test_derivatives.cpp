#include <cmath>

#include "check.hpp"
#include "whole_scene.hpp"

using namespace whole_scene;
using softffd::Settings;
using softffd::Vec3;

TEST(rates_of_inputs_reach_their_places_and_hold_for_one_step) {
  Scene scene;
  Settings& s = scene.body.settings;
  for (int order : {1, 2, 3}) scene.rate(reference_of(Family::load, 1), order, 10.0 * order);
  scene.rate(reference_of(Family::plane_velocity, 2), 1, 4);
  scene.rate(reference_of(Family::plane_normal, 0), 1, 5);
  scene.rate(reference_of(Family::pin_orientation, 3), 1, 6);
  scene.rate(reference_of(Family::pin_velocity, 0), 1, 7);
  scene.rate(reference_of(Family::pin_position, 1), 1, 8);
  scene.variables.apply(s);
  CHECK((*s.force_rate)(1, 1) == 5 && (*s.force_bend[0])(2, 1) == 10 && (*s.force_bend[1])(2, 1) == 15);
  CHECK(s.planes[1].acceleration == Vec3(0, 0, 4) && s.planes[1].normal_rate == Vec3(5, 0, 0) && s.pins[1].orientation_rate[3] == 6);
  CHECK(s.pins[1].velocity == Vec3(0, 8, 0) && s.pins[1].acceleration == Vec3::Zero());  // the rate of a pose wins
  scene.variables.forget_rates();
  CHECK(scene.variables.changed());
  scene.variables.apply(s);
  CHECK(s.force_rate->isZero(0) && s.force_bend[0]->isZero(0) && s.planes[1].acceleration == Vec3::Zero());
  CHECK(s.pins[1].velocity == Vec3::Zero() && s.pins[1].orientation_rate[3] == 0);
}

TEST(rates_that_no_input_takes_are_refused) {
  Scene scene;
  for (const FamilyInfo& info : present) {
    if (info.type != Type::Real) continue;
    const auto said = [&](int order, double value) { return refusal([&] { scene.rate(reference_of(info.family), order, value); }); };
    if (info.causality != Causality::input) {
      CHECK(said(1, 1).find(": is no input") != std::string::npos);
      continue;
    }
    const int highest = info.family == Family::force || info.family == Family::load ? 3 : 1;
    for (int order = 1; order <= highest; ++order) CHECK(said(order, 1).empty() && !said(order, NAN).empty());
    CHECK(said(0, 1).find(": wanted a derivative of order 1") != std::string::npos);
    CHECK(said(highest + 1, 1).find(": wanted a derivative of order 1") != std::string::npos);
  }
}

TEST(real_outputs_alone_have_a_derivative_and_of_first_order_alone) {
  Scene scene;
  for (const FamilyInfo& info : present) {
    const auto said = [&](int order) { return refusal([&] { scene.output_rate(reference_of(info.family), order); }); };
    const bool real = info.type == Type::Real, output = info.causality == Causality::output;
    CHECK(said(1).empty() == (real && output));
    CHECK(output || !real || said(1).find(": is no output") != std::string::npos);
    for (const int order : {-1, 0, 2, 3})
      CHECK(!(real && output) || said(order).find(": wanted a derivative of order 1") != std::string::npos);
  }
}
