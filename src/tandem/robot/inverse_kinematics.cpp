#include "tandem/robot/inverse_kinematics.h"
