// The reader of saved states. The checksum is put right: it is no guard against somebody who can compute it.
#include <fuzzer/FuzzedDataProvider.h>

#include "aras_visual_servo_sim/simulation/state/run_hash.hpp"
#include "small_simulation.hpp"
#include "target.hpp"

using namespace aras_visual_servo_sim;

namespace {

std::string withChecksum(std::string record) {
  RunHash hash;
  hash.add(record.data(), record.size());
  const std::uint64_t sum = hash.state();
  return record.append(reinterpret_cast<const char*>(&sum), sizeof(sum));
}

/** A true record with some of its bytes replaced, cut out or added; or one that is all made up. */
std::string forged(const std::string& truth, FuzzedDataProvider& bytes) {
  if (bytes.ConsumeIntegralInRange(0, 7) == 0) return bytes.ConsumeRemainingBytesAsString();
  std::string record = truth.substr(0, truth.size() - sizeof(std::uint64_t));
  while (bytes.remaining_bytes() > 0) {
    const auto at = bytes.ConsumeIntegralInRange<std::size_t>(0, record.size());
    const auto gone = bytes.ConsumeIntegralInRange<std::size_t>(0, 8);
    const auto come = bytes.ConsumeBytesAsString(bytes.ConsumeBool() ? gone : 8 - gone);
    record.replace(at, gone, come);
  }
  return record;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::unique_ptr<Simulation> kSimulation = fuzz::smallSimulation();
  static const std::string kTruth = [] {
    kSimulation->step(12);
    kSimulation->takeFrame(0);
    kSimulation->step(3);
    return kSimulation->saveState();
  }();
  Simulation& simulation = *kSimulation;
  FuzzedDataProvider bytes(data, size);
  const bool restored = fuzz::allow([&] { simulation.restoreState(withChecksum(forged(kTruth, bytes))); });
  const auto go_on = [&] {
    simulation.step(2);
    simulation.render(0);
  };
  if (restored && fuzz::allow(go_on) && !fuzz::finite(simulation)) __builtin_trap();
  simulation.restoreState(kTruth);
  return 0;
}
