// half_cheetah.xml and hopper.xml, carried along so that the program needs no file of its own at run
// time.
#pragma once

namespace sandwright {

extern const char kHalfCheetahXml[];
extern const char kHopperXml[];

}  // namespace sandwright
