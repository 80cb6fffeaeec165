#include <dlfcn.h>
#include <gtest/gtest.h>

#include <string>

namespace {

/** File of the library in which the dynamic linker finds a symbol first; empty if in none. */
std::string libraryOf(const char* symbol) {
  Dl_info info{};
  void* const address = dlsym(RTLD_DEFAULT, symbol);
  return address && dladdr(address, &info) != 0 ? info.dli_fname : "";
}

// The names are those of btSpatialTransformationMatrix::transformInverse and btMultibodyLink::updateCacheMultiDof.
TEST(BulletInline, LinkerFindsTheFunctionsOfThisLibraryBeforeThoseOfBullets) {
  for (const char* symbol : {"_ZN29btSpatialTransformationMatrix16transformInverseERK22btSymmetricSpatialDyadRS0_NS_"
                             "16eOutputOperationE",
                             "_ZN15btMultibodyLink19updateCacheMultiDofEPd"}) {
    EXPECT_NE(libraryOf(symbol).find("aras_visual_servo_sim_core"), std::string::npos)
        << symbol << " found in '" << libraryOf(symbol) << "'";
  }
}

}  // namespace
