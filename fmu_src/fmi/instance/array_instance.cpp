#include "instance/array_instance.hpp"

namespace softffd::fmi {

ArrayInstance::ArrayInstance(SceneFile scene, Logger log) : Instance(std::move(scene), std::move(log), Standard::fmi3) {
  for (Array& array : arrays()) {
    const fmi3ValueReference own = array.elements.front();
    arrays_.emplace(own, std::move(array));
  }
  arrays_.emplace(time, Array{{time}, false});
}

const ArrayInstance::Array& ArrayInstance::array(fmi3ValueReference reference) const {
  const auto found = arrays_.find(reference);
  if (found == arrays_.end()) throw CallError("value reference " + std::to_string(reference) + ": this scene has no such variable");
  return found->second;
}

std::size_t ArrayInstance::size_of(const Call& call) const {
  std::size_t wanted = 0;
  for (std::size_t n = 0; n < call.count; ++n) wanted += array(call.references[n]).elements.size();
  if (wanted != call.values)
    throw CallError("nValues: wanted " + std::to_string(wanted) + ", one for each element of the variables, got " +
                    std::to_string(call.values));
  return wanted;
}

template <class Each>
void ArrayInstance::for_each(const Call& call, Each&& each) const {
  for (std::size_t n = 0, at = 0; n < call.count; ++n) {
    const Array& own = array(call.references[n]);
    each(own.elements, at, n);
    at += own.elements.size();
  }
}

void ArrayInstance::get_arrays(Type type, const Call& call, double* values) {
  size_of(call);
  for_each(call, [&](const auto& own, std::size_t at, std::size_t n) {
    if (phase == instantiated && array(call.references[n]).output)
      throw CallError(name(own.front()) + ": has no value yet; wanted initialization mode, or an input or a parameter");
    if (call.references[n] != time) return get(type, own.data(), own.size(), values + at);
    if (type != Type::Real) throw CallError("time: is of type Float64, got a call for Int64");
    values[at] = last_successful_time();
  });
}

void ArrayInstance::set_arrays(Type type, const Call& call, const double* values) {
  std::vector<fmi2ValueReference> all;
  all.reserve(size_of(call));
  for_each(call, [&](const auto& own, std::size_t, std::size_t n) {
    if (call.references[n] == time) throw CallError("time: cannot be set");
    all.insert(all.end(), own.begin(), own.end());
  });
  set(type, all.data(), all.size(), values);
}

void ArrayInstance::get_array_derivatives(const Call& call, const fmi3Int32* orders, double* values) {
  size_of(call);
  for_each(call, [&](const auto& own, std::size_t at, std::size_t n) {
    if (call.references[n] == time) throw CallError("time: is no output, it has no output derivative");
    const std::vector<fmi2Integer> order(own.size(), orders[n]);
    get_output_derivatives(own.data(), own.size(), order.data(), values + at);
  });
}

}  // namespace softffd::fmi
