"""Robot descriptions as they are published, in the main kinds; written for these tests."""

# A small round-table robot with a ground frame, a ball, meshes to see, gazebo sensors and a gazebo drive.
SMALL = """<?xml version="1.0"?>
<robot name="small">
  <link name="base_footprint"/>
  <joint name="base_joint" type="fixed">
    <parent link="base_footprint"/><child link="base_link"/><origin xyz="0 0 0.010"/>
  </joint>
  <link name="base_link">
    <visual><geometry><mesh filename="package://small/base.stl" scale="0.001 0.001 0.001"/></geometry></visual>
    <collision><origin xyz="-0.03 0 0.07"/><geometry><box size="0.14 0.14 0.14"/></geometry></collision>
    <inertial><mass value="0.8"/><inertia ixx="0.002" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.002"/></inertial>
  </link>
  {wheels}
  <joint name="ball_joint" type="fixed">
    <parent link="base_link"/><child link="caster_back_link"/><origin xyz="-0.081 0 -0.004"/>
  </joint>
  <link name="caster_back_link">
    <collision><geometry><box size="0.03 0.009 0.02"/></geometry></collision>
    <inertial><mass value="0.005"/></inertial>
  </link>
  <joint name="imu_joint" type="fixed">
    <parent link="base_link"/><child link="imu_link"/><origin xyz="-0.032 0 0.068"/>
  </joint>
  <link name="imu_link"/>
  <joint name="scan_joint" type="fixed">
    <parent link="base_link"/><child link="base_scan"/><origin xyz="-0.032 0 0.172"/>
  </joint>
  <link name="base_scan">
    <collision><geometry><cylinder radius="0.055" length="0.03"/></geometry></collision>
    <inertial><mass value="0.1"/></inertial>
  </link>
  <gazebo reference="base_scan">
    <sensor type="ray" name="lds">
      <update_rate>5</update_rate>
      <ray>
        <scan><horizontal><samples>360</samples><min_angle>0.0</min_angle><max_angle>6.28319</max_angle></horizontal></scan>
        <range><min>0.12</min><max>3.5</max></range>
        <noise><type>gaussian</type><stddev>0.01</stddev></noise>
      </ray>
      <plugin name="laser" filename="libgazebo_ros_laser.so"/>
    </sensor>
  </gazebo>
  <gazebo reference="imu_link"><sensor type="imu" name="imu"><update_rate>100</update_rate></sensor></gazebo>
  <gazebo>
    <plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <leftJoint>wheel_left_joint</leftJoint><rightJoint>wheel_right_joint</rightJoint>
      <wheelSeparation>0.160</wheelSeparation><wheelDiameter>0.066</wheelDiameter>
      <wheelAcceleration>1</wheelAcceleration>
    </plugin>
  </gazebo>
</robot>
""".format(
    wheels="".join(
        f"""
  <joint name="wheel_{side}_joint" type="continuous">
    <parent link="base_link"/><child link="wheel_{side}_link"/>
    <origin xyz="0 {y} 0.023" rpy="-1.5708 0 0"/><axis xyz="0 0 1"/>
  </joint>
  <link name="wheel_{side}_link">
    <visual><geometry><mesh filename="package://small/tyre.stl"/></geometry></visual>
    <collision><geometry><cylinder radius="0.033" length="0.018"/></geometry></collision>
    <inertial><mass value="0.03"/></inertial>
  </link>"""
        for side, y in (("left", 0.08), ("right", -0.08))
    )
)

# The same with a depth camera in place of the lidar.
DEPTH = (
    SMALL[: SMALL.index('  <gazebo reference="base_scan">')] + SMALL[SMALL.index('  <gazebo reference="imu_link">') :]
).replace("base_scan", "camera_depth_link")

# A skid steer: four wheels, root above the ground, no gazebo tags, sensors by their names.
FOUR_WHEELS = """<robot name="four">
  <link name="base_link">
    <collision><origin xyz="0 0 0.12"/><geometry><box size="0.98 0.57 0.25"/></geometry></collision>
    <inertial><mass value="46"/></inertial>
  </link>
  {wheels}
  <joint name="lidar_mount" type="fixed">
    <parent link="base_link"/><child link="front_laser"/><origin xyz="0.3 0 0.35"/>
  </joint>
  <link name="front_laser"/>
  <joint name="camera_mount" type="fixed">
    <parent link="base_link"/><child link="camera_link"/><origin xyz="0.45 0 0.30" rpy="0 0.1 0"/>
  </joint>
  <link name="camera_link"/>
  <joint name="camera_optics" type="fixed">
    <parent link="camera_link"/><child link="camera_optical_frame"/><origin rpy="-1.5708 0 -1.5708"/>
  </joint>
  <link name="camera_optical_frame"/>
</robot>
""".format(
    wheels="".join(
        f"""
  <joint name="{end}_{side}_wheel" type="continuous">
    <parent link="base_link"/><child link="{end}_{side}_wheel_link"/>
    <origin xyz="{x} {y} 0.03"/><axis xyz="0 1 0"/>
  </joint>
  <link name="{end}_{side}_wheel_link">
    <collision>
      <origin rpy="1.5708 0 0"/><geometry><cylinder radius="0.165" length="0.114"/></geometry>
    </collision>
    <inertial><mass value="2.6"/></inertial>
  </link>"""
        for end, x in (("front", 0.256), ("rear", -0.256))
        for side, y in (("left", 0.2854), ("right", -0.2854))
    )
)

# A body of meshes with its inertia only, a swivelling caster, sonars, and speeds at its joints.
MESHES = """<robot name="meshes">
  <link name="base_link">
    <visual><geometry><mesh filename="package://meshes/body.dae"/></geometry></visual>
    <inertial>
      <origin xyz="-0.1 0 0.1"/><mass value="12"/>
      <inertia ixx="0.2" ixy="0" ixz="0" iyy="0.29" iyz="0" izz="0.41"/>
    </inertial>
  </link>
  {wheels}
  <joint name="swivel" type="continuous">
    <parent link="base_link"/><child link="fork"/><origin xyz="-0.25 0 0.02"/><axis xyz="0 0 1"/>
  </joint>
  <link name="fork"/>
  <joint name="rear_wheel" type="continuous">
    <parent link="fork"/><child link="rear_wheel_link"/><origin xyz="-0.02 0 -0.07"/><axis xyz="0 1 0"/>
  </joint>
  <link name="rear_wheel_link">
    <visual><origin rpy="1.5708 0 0"/><geometry><cylinder radius="0.05" length="0.02"/></geometry></visual>
  </link>
  {sonars}
</robot>
""".format(
    wheels="".join(
        f"""
  <joint name="{side}_wheel" type="continuous">
    <parent link="base_link"/><child link="{side}_wheel_link"/><origin xyz="0 {y} 0"/><axis xyz="0 1 0"/>
    <limit effort="10" velocity="4.0"/>
  </joint>
  <link name="{side}_wheel_link">
    <visual><origin rpy="1.5708 0 0"/><geometry><cylinder radius="0.1" length="0.04"/></geometry></visual>
  </link>"""
        for side, y in (("left", 0.17), ("right", -0.17))
    ),
    sonars="".join(
        f"""
  <joint name="sonar_{n}_mount" type="fixed">
    <parent link="base_link"/><child link="sonar_{n}"/><origin xyz="0.1 {y} 0.05" rpy="0 0 {yaw}"/>
  </joint>
  <link name="sonar_{n}"/>"""
        for n, (y, yaw) in enumerate(((0.1, 0.5), (-0.1, -0.5)))
    ),
)
