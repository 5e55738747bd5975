// What is known of URDF: which elements and attributes are read, dropped with a note, or refused.
#pragma once
#include "xml.hpp"

namespace rdm::import {

// Walks links, joints and what they are made of. Refuses what could change mass, pose, axis, range or coupling
// and is not read: an element or attribute that is not known (a slip of the pen: `rrpy`), one that closes
// loops, and a second one where URDF has one. What other programs added for themselves stays for the notes.
void check_urdf(const Element& robot);

}  // namespace rdm::import
