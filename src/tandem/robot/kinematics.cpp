#include "tandem/robot/kinematics.h"
