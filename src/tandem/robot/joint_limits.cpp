#include "tandem/robot/joint_limits.h"
