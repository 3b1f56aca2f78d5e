/// The functions of FMI 3.0 that get and set variables and get derivatives of outputs.
#include <algorithm>

extern "C" {
#include "fmi3Functions.h"
}

#include "calls/fmi3.hpp"

using namespace softffd::fmi;

namespace {

fmi3Status none(fmi3Instance handle, const char* name, unsigned allowed, std::size_t count) noexcept {
  return guarded3(handle, {name, allowed}, {}, [&](Instance&) {
    if (count > 0) throw CallError(std::string(name) + ": there are no variables of this type");
  });
}

}  // namespace

extern "C" {

fmi3Status fmi3GetFloat64(fmi3Instance handle, const fmi3ValueReference references[], size_t count, fmi3Float64 values[], size_t room) {
  const ArrayInstance::Call call{references, count, room};
  return guarded3(handle, function3::get_float64, {{{"valueReferences", references}, {"values", values}}, count},
                  [&](ArrayInstance& instance) { instance.get_arrays(Type::Real, call, values); });
}

fmi3Status fmi3SetFloat64(fmi3Instance handle, const fmi3ValueReference references[], size_t count, const fmi3Float64 values[],
                          size_t given) {
  const ArrayInstance::Call call{references, count, given};
  return guarded3(handle, function3::set_float64, {{{"valueReferences", references}, {"values", values}}, count},
                  [&](ArrayInstance& instance) { instance.set_arrays(Type::Real, call, values); });
}

fmi3Status fmi3GetInt64(fmi3Instance handle, const fmi3ValueReference references[], size_t count, fmi3Int64 values[], size_t room) {
  const ArrayInstance::Call call{references, count, room};
  return guarded3(handle, function3::get_int64, {{{"valueReferences", references}, {"values", values}}, count},
                  [&](ArrayInstance& instance) {
                    std::vector<double> numbers(instance.size_of(call));
                    instance.get_arrays(Type::Integer, call, numbers.data());
                    std::copy(numbers.begin(), numbers.end(), values);  // counts below 2^53
                  });
}

fmi3Status fmi3SetInt64(fmi3Instance handle, const fmi3ValueReference references[], size_t count, const fmi3Int64 values[], size_t given) {
  const ArrayInstance::Call call{references, count, given};
  return guarded3(handle, function3::set_int64, {{{"valueReferences", references}, {"values", values}}, count},
                  [&](ArrayInstance& instance) {
                    const std::vector<double> numbers(values, values + instance.size_of(call));
                    instance.set_arrays(Type::Integer, call, numbers.data());
                  });
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance handle, const fmi3ValueReference references[], size_t count, const fmi3Int32 orders[],
                                    fmi3Float64 values[], size_t room) {
  const ArrayInstance::Call call{references, count, room};
  return guarded3(handle, function3::get_output_derivatives,
                  {{{"valueReferences", references}, {"orders", orders}, {"values", values}}, count},
                  [&](ArrayInstance& instance) { instance.get_array_derivatives(call, orders, values); });
}

#define SOFTFFD_NONE_OF(Kind)                                                                                           \
  fmi3Status fmi3Get##Kind(fmi3Instance handle, const fmi3ValueReference[], size_t count, fmi3##Kind[], size_t) {       \
    return none(handle, "fmi3Get" #Kind, function3::any_phase, count);                                                  \
  }                                                                                                                     \
  fmi3Status fmi3Set##Kind(fmi3Instance handle, const fmi3ValueReference[], size_t count, const fmi3##Kind[], size_t) { \
    return none(handle, "fmi3Set" #Kind, function3::settable, count);                                                   \
  }
SOFTFFD_NONE_OF(Float32)
SOFTFFD_NONE_OF(Int8)
SOFTFFD_NONE_OF(UInt8)
SOFTFFD_NONE_OF(Int16)
SOFTFFD_NONE_OF(UInt16)
SOFTFFD_NONE_OF(Int32)
SOFTFFD_NONE_OF(UInt32)
SOFTFFD_NONE_OF(UInt64)
SOFTFFD_NONE_OF(Boolean)
SOFTFFD_NONE_OF(String)
#undef SOFTFFD_NONE_OF

fmi3Status fmi3GetBinary(fmi3Instance handle, const fmi3ValueReference[], size_t count, size_t[], fmi3Binary[], size_t) {
  return none(handle, "fmi3GetBinary", function3::any_phase, count);
}

fmi3Status fmi3SetBinary(fmi3Instance handle, const fmi3ValueReference[], size_t count, const size_t[], const fmi3Binary[], size_t) {
  return none(handle, "fmi3SetBinary", function3::settable, count);
}

fmi3Status fmi3GetClock(fmi3Instance handle, const fmi3ValueReference[], size_t count, fmi3Clock[]) {
  return none(handle, "fmi3GetClock", function3::any_phase, count);
}

fmi3Status fmi3SetClock(fmi3Instance handle, const fmi3ValueReference[], size_t count, const fmi3Clock[]) {
  return none(handle, "fmi3SetClock", function3::settable, count);
}

}  // extern "C"
