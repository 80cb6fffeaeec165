#include "bind_contacts.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

namespace py = pybind11;

namespace aras_visual_servo_sim {

void bindContacts(py::class_<Simulation>& type) {
  type.def_property_readonly(
      "contacts",
      [](const Simulation& self) {
        py::list contacts;
        for (const ContactForce& contact : self.world().contacts()) {
          py::dict entry;
          entry["a"] = contact.a;
          entry["b"] = contact.b;
          entry["point_m"] = contact.point_W;
          entry["normal"] = contact.normal_W;
          entry["depth_m"] = contact.depth_m;
          entry["force_n"] = contact.force_W;
          contacts.append(entry);
        }
        return contacts;
      },
      "Points of contact of the last step: a list of {a, b: names of links, solids or ground_plane; point_m "
      "(3,), "
      "normal (3,) from b to a, force_n (3,) on a, all in W; depth_m}.");
  type.def_property_readonly(
      "unsettled_steps", [](const Simulation& self) { return self.world().unsettledSteps(); },
      "Steps since the last reset whose contacts did not settle within the bound on the work of a step.");
}

}  // namespace aras_visual_servo_sim
